// Contact generation: once per substep, the half spaces that each particle must stay in. In: positions and previous
// positions of a participant, poses of the bodies. Out: up to three contacts per particle, and the distance within
// which nothing else is met.
//
// - Everything is computed in the frame of the body: the particle moves from b0, seen from the old pose, to b1. So a
//   body at 100 m/s is the same as a particle at 100 m/s, and the path decides. (Speculative contacts, as in Jolt and
//   Bullet.)
// - A path that enters the body gets the tangent plane where it enters; any other the plane at the closest point to
//   b1. Bodies farther from b1 than 2 h + |b1 - b0| are skipped, with h the thickness. That leaves room for the
//   constraints to move the particle; what moves farther is swept at the end of the substep (contact_projection.c).
// - A particle that starts nearer than h is moved out at the push-out speed, together with its previous position, so
//   that the correction gives no velocity. While it is deeper than COLLISION_SHALLOW, its own outward motion gives
//   none either: links between particles that are moved out in different directions would gain energy.
// - Closest points of closed forms, and the half spaces of all bodies, are computed eight particles at a time. One by
//   one are only paths that may enter a body, deep starts, and particles that already have all contacts.
// - Lengths come from the participant (thickness a quarter of its mean edge), so a scene at 1/100 or 100 times its
//   size behaves the same.

#include "body_queries.h"
#include "collision_state.h"
#include "near_bodies.h"
#include "reaction.h"
#include "particle_contacts.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum
{
    PLANES = COLLISION_BLOCK + 2 * COLLISION_GROUP, // two lists, each padded
};

// Planes of one body, of the particles that are near it, in the frame of the body.
typedef struct found_planes
{
    int count;
    int32_t near[PLANES]; // number of the candidate
    float point[3][PLANES], normal[3][PLANES];
    wisp_vec3 motion[PLANES]; // m, of a surface in the substep
    float now[PLANES];        // m, signed distance of the particle
    float start[PLANES];      // m, at the start of the substep, less the thickness
    int special_count;
    int32_t special[PLANES];                      // those that may be swept or start deep
    float clear[PLANES];                          // m, of each candidate: nothing else within this distance
    int32_t particle_x4[PLANES], row_x16[PLANES]; // from the beginning of the block
} found_planes;

static wisp_vec3 load_candidate( const collision_block* block, bool at_end, int i )
{
    return at_end ? ( wisp_vec3 ){ block->to[0][i], block->to[1][i], block->to[2][i] }
                  : ( wisp_vec3 ){ block->from[0][i], block->from[1][i], block->from[2][i] };
}

static wisp_vec3 load_one( float ( *from )[PLANES], int i )
{
    return ( wisp_vec3 ){ from[0][i], from[1][i], from[2][i] };
}

static void store_one( float ( *to )[PLANES], int i, wisp_vec3 v )
{
    to[0][i] = v.x;
    to[1][i] = v.y;
    to[2][i] = v.z;
}

// ---- closest points ----

static void query_shape( const collision_find_args* args, const collision_view* view, collision_block* block,
                         found_planes* planes )
{
    const wisp_shape_query_args query = {
        .shape = view->body->shape,
        .from = { block->from[0], block->from[1], block->from[2] },
        .to = { block->to[0], block->to[1], block->to[2] },
        .path = block->path,
        .reach = block->reach,
        .thickness = view->thickness,
        .shallow = COLLISION_SHALLOW * view->thickness,
        .clearance = planes->clear,
        .near = planes->near,
        .point = { planes->point[0], planes->point[1], planes->point[2] },
        .normal = { planes->normal[0], planes->normal[1], planes->normal[2] },
        .distance = planes->now,
        .start = planes->start,
        .special = planes->special,
    };
    int32_t special_count;
    planes->count = args->kernels->query_shape( &query, block->candidate_count, &special_count );
    planes->special_count = special_count;
}

// Return how far a particle may have come through a body. Seen from the closest part of a solid surface it comes from
// `start`; other parts, which move otherwise, are farther from where it ends, and too thick to be crossed in between.
static float path_along( const collision_view* view, const collision_block* block, int n, wisp_vec3 start )
{
    const bool is_solid = view->body->follows && view->body->double_sided == false;
    return is_solid ? wisp_v3_length( wisp_v3_sub( load_candidate( block, true, n ), start ) ) : block->path[n];
}

static bool has_tracks( const collision_find_args* args, const collision_view* view )
{
    return args->tracked != NULL && view->body->tree != NULL && view->body->track >= 0;
}

// Particles that are no candidates forget what they have kept of the body: how far they moved since is not known.
static void forget_others( const collision_find_args* args, const collision_view* view, const collision_block* block,
                           int candidate_count )
{
    bool is_candidate[COLLISION_BLOCK] = { false };
    for ( int n = 0; n < candidate_count; ++n )
    {
        is_candidate[collision_slot( block, block->candidates[n] ) - block->begin] = true;
    }
    for ( int slot = block->begin; slot < block->end; ++slot )
    {
        if ( is_candidate[slot - block->begin] == false )
        {
            args->tracked[slot][view->body->track] = -1;
            args->free[slot][view->body->track] = 0.0f;
        }
    }
}

static void track_candidates( const collision_find_args* args, const collision_view* view,
                              const collision_block* block, const wisp_mesh_query* queries,
                              wisp_surface_point* nearest, bool* is_near, wisp_vec3* motion )
{
    collision_track tracks[COLLISION_BLOCK];
    collision_tracked_query tracked[COLLISION_BLOCK];
    const int t = view->body->track;
    const float shift = collision_surface_shift( view );
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        const int slot = collision_slot( block, block->candidates[n] );
        tracks[n] = ( collision_track ){ args->tracked[slot][t], args->free[slot][t], args->origin[slot][t] };
        // particles gain speed within the step
        const float ahead = COLLISION_MARGIN * ( block->path[n] - shift ) * (float)args->substeps_left;
        tracked[n] = ( collision_tracked_query ){ queries[n].point, queries[n].radius, queries[n].radius, ahead };
    }
    collision_track_closest( args->kernels, view, tracked, tracks, block->candidate_count, args->is_first, NULL,
                             nearest, is_near, motion );
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        const int slot = collision_slot( block, block->candidates[n] );
        args->tracked[slot][t] = tracks[n].triangle;
        args->free[slot][t] = tracks[n].free;
        args->origin[slot][t] = tracks[n].origin;
    }
}

// The same for meshes, convex polyhedra and height fields.
static void query_mesh( const collision_find_args* args, const collision_view* view, collision_block* block,
                        found_planes* planes )
{
    wisp_mesh_query queries[COLLISION_BLOCK];
    wisp_surface_point nearest[COLLISION_BLOCK];
    bool is_near[COLLISION_BLOCK];
    wisp_vec3 motion[COLLISION_BLOCK];
    const float shift = collision_surface_shift( view );
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        block->path[n] += shift;
        queries[n] = ( wisp_mesh_query ){ .point = load_candidate( block, true, n ),
                                          .radius = block->reach[n],
                                          .time = view->end };
    }
    if ( has_tracks( args, view ) )
    {
        track_candidates( args, view, block, queries, nearest, is_near, motion );
    }
    else
    {
        collision_closest( view, queries, block->candidate_count, nearest, is_near, motion );
    }
    planes->count = planes->special_count = 0;
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        const wisp_surface_point* s = nearest + n;
        planes->clear[n] = is_near[n] == false ? block->reach[n] : s->distance > 0.0f ? s->distance : INFINITY;
        if ( is_near[n] )
        {
            const int m = planes->count++;
            const wisp_vec3 from = wisp_v3_mul_add( load_candidate( block, false, n ), 1.0f, motion[n] );
            const float start = collision_plane_gap( view, s, from );
            planes->motion[m] = motion[n];
            planes->near[m] = n;
            store_one( planes->point, m, s->point );
            store_one( planes->normal, m, s->normal );
            planes->now[m] = s->distance;
            planes->start[m] = start;
            planes->special[planes->special_count] = m;
            planes->special_count += fabsf( s->distance ) <= path_along( view, block, n, from ) ||
                                             start < -COLLISION_SHALLOW * view->thickness
                                         ? 1
                                         : 0;
        }
    }
}

// ---- paths that enter, and deep starts ----

static int32_t seed_of( const collision_find_args* args, const collision_view* view, const collision_block* block,
                        int n )
{
    return has_tracks( args, view ) ? args->tracked[collision_slot( block, block->candidates[n] )][view->body->track]
                                    : -1;
}

// A path that enters the body gets the plane where it enters. @return false if there is no contact
static bool sweep_one( const collision_find_args* args, const collision_view* view, collision_block* block,
                       found_planes* planes, int m )
{
    const int n = planes->near[m];
    const wisp_vec3 from = load_candidate( block, false, n ), to = load_candidate( block, true, n );
    wisp_surface_point plane = { load_one( planes->point, m ), load_one( planes->normal, m ), planes->now[m] };
    wisp_surface_point entry;
    wisp_vec3 motion = view->body->follows ? planes->motion[m] : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, body_motion;
    const wisp_vec3 start = wisp_v3_mul_add( from, 1.0f, motion );
    const bool swept = fabsf( plane.distance ) <= path_along( view, block, n, start ) &&
                       collision_cast( view, from, to, &entry, &body_motion );
    if ( swept )
    {
        plane = entry;
        motion = planes->motion[m] = body_motion;
        store_one( planes->point, m, plane.point );
        store_one( planes->normal, m, plane.normal );
        planes->clear[n] = 0.0f;
        planes->now[m] = wisp_v3_dot( plane.normal, wisp_v3_sub( to, plane.point ) );
        if ( planes->now[m] > block->reach[n] )
        {
            return false;
        }
    }
    planes->start[m] = collision_start_gap( view, &plane, from, motion, swept, seed_of( args, view, block, n ) );
    return true;
}

static void copy_plane( found_planes* source, int from, found_planes* planes, int to )
{
    planes->near[to] = source->near[from];
    planes->motion[to] = source->motion[from];
    planes->particle_x4[to] = source->particle_x4[from];
    planes->row_x16[to] = source->row_x16[from];
    store_one( planes->point, to, load_one( source->point, from ) );
    store_one( planes->normal, to, load_one( source->normal, from ) );
    planes->now[to] = source->now[from];
    planes->start[to] = source->start[from];
}

static void sweep_special( const collision_find_args* args, const collision_view* view, collision_block* block,
                           found_planes* planes )
{
    bool is_dropped[PLANES];
    bool any = false;
    for ( int i = 0; i < planes->special_count; ++i )
    {
        const int m = planes->special[i];
        const bool touches = sweep_one( args, view, block, planes, m );
        if ( touches == false && any == false )
        {
            memset( is_dropped, 0, sizeof( is_dropped ) );
        }
        if ( touches == false )
        {
            is_dropped[m] = any = true;
        }
    }
    int kept = 0;
    for ( int m = 0; any && m < planes->count; ++m )
    {
        copy_plane( planes, m, planes, kept );
        kept += is_dropped[m] ? 0 : 1;
    }
    planes->count = any ? kept : planes->count;
}

// ---- half spaces ----

static float contact_gap( const collision_contact* c, wisp_vec3 p )
{
    return wisp_v3_dot( wisp_v3_load( c->normal ), wisp_v3_sub( p, wisp_v3_load( c->point ) ) ) - c->gap;
}

// The frame of a surface is that of the world, so what its points move is added to what the frame does.
static void write_motions( const found_planes* planes, int first, int end, float* rows )
{
    for ( int m = first; m < end; ++m )
    {
        float* row = rows + planes->row_x16[m] + offsetof( collision_contact, motion ) / sizeof( float );
        row[0] = planes->motion[m].x;
        row[1] = planes->motion[m].y;
        row[2] = planes->motion[m].z;
    }
}

// Note the thickness and the body of a contact, and the velocity of a bounce.
static void note_contact( const collision_find_args* args, const collision_view* view, collision_block* block,
                          int slot, int place, const collision_contact* c )
{
    block->thickness[slot - block->begin][place] = view->thickness;
    if ( args->contact_body != NULL )
    {
        args->contact_body[slot][place] = (int32_t)( view->body - args->state->bodies );
    }
    if ( args->bounce != NULL )
    {
        args->bounce[slot][place] = collision_bounce( args, view, c, slot );
    }
}

static void note_contacts( const collision_find_args* args, const collision_view* view, collision_block* block,
                           const found_planes* planes, int count )
{
    for ( int m = 0; m < count; ++m )
    {
        const int row = planes->row_x16[m] / 16, slot = block->begin + row / WISP_COLLISION_CONTACTS;
        const int place = row % WISP_COLLISION_CONTACTS;
        note_contact( args, view, block, slot, place, args->contact[slot] + place );
    }
}

// The reaction to what moves particles out: where the previous position follows farther than the position.
static void add_recovery( const collision_find_args* args, const collision_view* view, const collision_block* block,
                          const found_planes* planes, int first, int end, float ( *before )[6] )
{
    double* sum = args->sums[view->body - args->state->bodies];
    for ( int m = first; m < end; ++m )
    {
        const size_t quad = (size_t)block->begin * 4 + (size_t)planes->particle_x4[m];
        const double mass = 1.0 / (double)args->position[quad + 3];
        collision_add_reaction( sum, mass / (double)args->dt, wisp_v3_load( before[m] ),
                                wisp_v3_load( before[m] + 3 ), wisp_v3_load( args->position + quad ),
                                wisp_v3_load( args->previous + quad ) );
    }
}

static void scale_friction( const collision_find_args* args, const collision_block* block, const found_planes* planes,
                            int first, int end, float* rows )
{
    for ( int m = first; m < end; ++m )
    {
        const float factor = args->maps.friction[block->begin + planes->particle_x4[m] / 4];
        float* row = rows + planes->row_x16[m];
        row[offsetof( collision_contact, static_friction ) / sizeof( float )] *= factor;
        row[offsetof( collision_contact, kinetic_friction ) / sizeof( float )] *= factor;
    }
}

// A thinner vertex keeps its thickness from a plane as one of the whole thickness does from a plane farther inside.
static void move_planes_inside( const collision_find_args* args, const collision_block* block, found_planes* planes )
{
    for ( int m = 0; m < planes->count; ++m )
    {
        const float inside =
            collision_thinner( &args->maps, collision_slot( block, block->candidates[planes->near[m]] ) );
        const wisp_vec3 point = load_one( planes->point, m ), normal = load_one( planes->normal, m );
        store_one( planes->point, m, wisp_v3_mul_add( point, -inside, normal ) );
        planes->now[m] += inside;
        planes->start[m] += inside;
    }
}

// Move particles out and write rows. Later bodies see the new positions.
static void write_rows( const collision_find_args* args, const collision_view* view, collision_block* block,
                        found_planes* planes, int first, int count, float* rows )
{
    // the last group is padded with its last particle
    const int end = first + count,
              padded = first + ( count + COLLISION_GROUP - 1 ) / COLLISION_GROUP * COLLISION_GROUP;
    for ( int m = end; m < padded; ++m )
    {
        copy_plane( planes, end - 1, planes, m );
    }
    const size_t quad = (size_t)block->begin * 4;
    const wisp_half_space_rows_args half_spaces = {
        .before = view->before,
        .after = view->after,
        .thickness = view->thickness,
        .shallow = COLLISION_SHALLOW * view->thickness,
        .recovery = args->recovery,
        .static_friction = view->static_friction,
        .kinetic_friction = view->kinetic_friction,
        .point = { planes->point[0] + first, planes->point[1] + first, planes->point[2] + first },
        .normal = { planes->normal[0] + first, planes->normal[1] + first, planes->normal[2] + first },
        .now = planes->now + first,
        .start = planes->start + first,
        .position = args->position + quad,
        .previous = args->previous + quad,
        .rows = rows,
        .particle_x4 = planes->particle_x4 + first,
        .row_x16 = planes->row_x16 + first,
    };
    float before[PLANES][6];
    for ( int m = first; args->sums != NULL && m < end; ++m )
    {
        memcpy( before[m], half_spaces.position + planes->particle_x4[m], 3 * sizeof( float ) );
        memcpy( before[m] + 3, half_spaces.previous + planes->particle_x4[m], 3 * sizeof( float ) );
    }
    const bool moved = args->kernels->half_space_rows( &half_spaces, padded - first );
    if ( view->body->follows )
    {
        write_motions( planes, first, end, rows );
    }
    if ( moved && args->sums != NULL )
    {
        add_recovery( args, view, block, planes, first, end, before );
    }
    if ( args->maps.friction != NULL )
    {
        scale_friction( args, block, planes, first, end, rows );
    }
    for ( int m = first; moved && block->is_last == false && m < end; ++m )
    {
        const int i = block->candidates[planes->near[m]];
        for ( int k = 0; k < 3; ++k )
        {
            block->now[k][i] = half_spaces.position[planes->particle_x4[m] + k];
            block->old[k][i] = half_spaces.previous[planes->particle_x4[m] + k];
        }
    }
}

// Of a particle that has all contacts, the farthest gives way to a nearer one.
static void replace_farthest( const collision_find_args* args, const collision_view* view, collision_block* block,
                              int slot, const collision_contact* found )
{
    const wisp_vec3 p = wisp_v3_load( args->position + (size_t)slot * 4 );
    collision_contact* all = args->contact[slot];
    int place = 0;
    for ( int i = 1; i < WISP_COLLISION_CONTACTS; ++i )
    {
        place = contact_gap( all + i, p ) > contact_gap( all + place, p ) ? i : place;
    }
    if ( contact_gap( found, p ) < contact_gap( all + place, p ) )
    {
        all[place] = *found;
        note_contact( args, view, block, slot, place, found );
    }
}

// Particles that have all contacts, from `first` on. They get a row beside those of the block.
static void add_beyond( const collision_find_args* args, const collision_view* view, collision_block* block,
                        found_planes* planes, int first, int count )
{
    collision_contact found[COLLISION_GROUP];
    for ( int done = 0; done < count; done += COLLISION_GROUP )
    {
        const int at = first + done, n = count - done < COLLISION_GROUP ? count - done : COLLISION_GROUP;
        for ( int m = 0; m < n; ++m )
        {
            planes->row_x16[at + m] = 16 * m;
        }
        write_rows( args, view, block, planes, at, n, found[0].point );
        for ( int m = 0; m < n; ++m )
        {
            replace_farthest( args, view, block, block->begin + planes->particle_x4[at + m] / 4, found + m );
        }
    }
}

// Give each particle a row, those that have all contacts behind the others.
// @return number of particles with room for one more contact
static int assign_rows( const collision_find_args* args, const collision_block* block, found_planes* planes )
{
    int full = 0;
    for ( int m = 0; m < planes->count; ++m )
    {
        const int slot = collision_slot( block, block->candidates[planes->near[m]] );
        const int place = args->count[slot]++;
        planes->particle_x4[m] = 4 * ( slot - block->begin );
        planes->row_x16[m] = 16 * ( WISP_COLLISION_CONTACTS * ( slot - block->begin ) + place );
        full += place >= WISP_COLLISION_CONTACTS ? 1 : 0;
    }
    if ( full == 0 )
    {
        return planes->count;
    }
    found_planes all = *planes;
    const int room = all.count - full;
    int first = 0, beyond = ( room + COLLISION_GROUP - 1 ) / COLLISION_GROUP * COLLISION_GROUP;
    for ( int m = 0; m < all.count; ++m )
    {
        const bool is_full = args->count[block->begin + all.particle_x4[m] / 4] > WISP_COLLISION_CONTACTS;
        copy_plane( &all, m, planes, is_full ? beyond++ : first++ );
    }
    return room;
}

static void add_planes( const collision_find_args* args, const collision_view* view, collision_block* block,
                        found_planes* planes )
{
    const int room = assign_rows( args, block, planes );
    if ( planes->count > 0 && block->met++ == 0 && args->can_squeeze )
    {
        const size_t quad = (size_t)block->begin * 4,
                     bytes = (size_t)( block->end - block->begin ) * sizeof( float[4] );
        memcpy( block->was[0], args->position + quad, bytes );
        memcpy( block->was[1], args->previous + quad, bytes );
    }
    if ( room > 0 )
    {
        write_rows( args, view, block, planes, 0, room, args->contact[block->begin][0].point );
        if ( args->contact_body != NULL || args->bounce != NULL || args->can_squeeze )
        {
            note_contacts( args, view, block, planes, room );
        }
    }
    const int first = ( room + COLLISION_GROUP - 1 ) / COLLISION_GROUP * COLLISION_GROUP;
    add_beyond( args, view, block, planes, first, planes->count - room );
}

// ---- a block and its bodies ----

void collision_meet( const collision_find_args* args, const collision_view* view, collision_block* block )
{
    const bool is_tracked = has_tracks( args, view );
    const float apart = collision_ball_distance( view, block->lower, block->upper );
    if ( apart > 2.0f * view->thickness )
    {
        collision_skip_block( view, apart, block );
        if ( is_tracked )
        {
            forget_others( args, view, block, 0 );
        }
        return;
    }
    collision_cull_block( args, view, block );
    if ( is_tracked )
    {
        forget_others( args, view, block, block->candidate_count );
    }
    if ( block->candidate_count == 0 )
    {
        return;
    }
    found_planes planes;
    if ( collision_is_closed_form( view->body ) == false )
    {
        query_mesh( args, view, block, &planes );
    }
    else
    {
        query_shape( args, view, block, &planes );
    }
    sweep_special( args, view, block, &planes );
    if ( args->maps.thickness != NULL )
    {
        move_planes_inside( args, block, &planes );
    }
    for ( int n = 0; n < block->candidate_count; ++n )
    {
        float* clear = block->clear + block->candidates[n];
        *clear = planes.clear[n] < *clear ? planes.clear[n] : *clear;
    }
    add_planes( args, view, block, &planes );
}

// Return the most that a moving particle of the block is clear of the bodies that it has met, m.
static float most_clear( const collision_block* block )
{
    float most = 0.0f;
    for ( int i = 0; i < block->count; ++i )
    {
        const bool moves = ( block->moving[i / COLLISION_GROUP] >> i % COLLISION_GROUP & 1 ) != 0;
        most = moves ? collision_larger( block->clear[i], most ) : most;
    }
    return most;
}

static void meet_bodies( wisp_frame* frame, const wisp_span* span, const collision_find_args* args,
                         collision_block* block )
{
    collision_view view;
    collision_walk walk = collision_begin_walk( args->state, span->entity, block->lower, block->upper );
    while ( collision_walk_on( frame, span, args->state, &walk, 0.0f, &view ) )
    {
        block->is_last = collision_walk_ends( args->state, &walk );
        collision_meet( args, &view, block );
    }
    while ( walk.passed < INFINITY &&
            collision_walk_back( frame, span, args->state, &walk, most_clear( block ), &view ) )
    {
        collision_meet( args, &view, block );
    }
    for ( int i = 0; i < block->count && walk.near != NULL; ++i )
    {
        block->clear[i] = collision_smaller( walk.near->beyond, block->clear[i] );
        block->free_radius[i] = collision_smaller( walk.free, block->free_radius[i] );
    }
}

collision_find_args collision_find_args_of( wisp_frame* frame, const wisp_span* span, const collision_state* state )
{
    const wisp_entity e = span->entity;
    const collision_settings* settings = wisp_frame_column( frame, e, state->settings, 0 );
    const bool is_last = span->substep + 1 == wisp_frame_substeps( frame, e ) || state->searches_all;
    const wisp_vec3* gravity = wisp_frame_column( frame, e, WISP_PARTICLE_GRAVITY, 0 );
    return ( collision_find_args ){
        .kernels = wisp_frame_kernels( frame ),
        .position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
        .previous = wisp_frame_column( frame, e, WISP_PARTICLE_PREVIOUS, 0 ),
        .count = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 0 ),
        .found = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 1 ),
        .contact = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 2 ),
        .recovery = settings->max_push_out_speed * wisp_frame_dt( frame, e ),
        .state = state,
        .can_squeeze = state->body_count > 1,
        .contact_body = wisp_frame_column( frame, e, state->contact_body, 0 ),
        .bounce = wisp_frame_column( frame, e, state->bounce, 0 ),
        .velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 ),
        .gravity = gravity != NULL ? *gravity : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f },
        .dt = wisp_frame_dt( frame, e ),
        .maps = collision_maps_of( frame, e, state ),
        .has_settled = span->substep > 0 && is_last == false,
        .settles = is_last == false,
        .tracked = wisp_frame_column( frame, e, state->tracked, 0 ),
        .free = wisp_frame_column( frame, e, state->tracked, 1 ),
        .origin = wisp_frame_column( frame, e, state->tracked, 2 ),
        .is_first = span->substep == 0,
        .substeps_left = wisp_frame_substeps( frame, e ) - 1 - span->substep,
    };
}

void collision_find_block( wisp_frame* frame, const wisp_span* span, const collision_find_args* args, int begin,
                           int end )
{
    collision_block block;
    collision_begin_block( args, begin, end, &block );
    if ( block.count > 0 )
    {
        meet_bodies( frame, span, args, &block );
    }
    if ( block.met > 1 )
    {
        collision_squeeze( args, &block );
    }
    collision_end_block( args, &block );
}

void collision_find( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    collision_find_args args = collision_find_args_of( frame, span, state );
    const wisp_span particles = wisp_frame_particles( frame, span );
    for ( int begin = particles.begin; begin < particles.end; begin += COLLISION_BLOCK )
    {
        const int left = particles.end - begin;
        args.sums = collision_reaction_sums( frame, span->entity, state, begin / COLLISION_BLOCK );
        collision_find_block( frame, span, &args, begin,
                              left < COLLISION_BLOCK ? particles.end : begin + COLLISION_BLOCK );
    }
}
