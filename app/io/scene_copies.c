// Copies of an entry in a grid: read as one entry, and made into entries of their own once all names are known.
#include "groom.h"

#include "groom_internal.h"
#include "scene.h"
#include "scene_parts.h"
#include "trig.h"

#include "wisp/module/definition.h"
#include "wisp/module/random.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- scatter ----

// Strands around other strands: each is its target moved by an offset, uniform in a disc across the root's direction.

static const float TWO_PI = 6.28318531f;

enum
{
    RANDOM_STREAM = 0x73636174, // any number that no other stream of the program has
    DRAW_DISTANCE = 0,
    DRAW_TURN = 1,
};

// Where a strand sets out: along its first segment that has a length; upwards if none has one.
static wisp_vec3 root_direction( const wisp_vec3* points, int count )
{
    for ( int v = 1; v < count; ++v )
    {
        wisp_vec3 d = { points[v].x - points[0].x, points[v].y - points[0].y, points[v].z - points[0].z };
        float length = sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
        if ( length > 0.0f )
        {
            return ( wisp_vec3 ){ d.x / length, d.y / length, d.z / length };
        }
    }
    return ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
}

// A unit vector across another (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"), and the third one.
static void across( wisp_vec3 n, wisp_vec3* a, wisp_vec3* b )
{
    float sign = copysignf( 1.0f, n.z );
    float s = -1.0f / ( sign + n.z ), t = n.x * n.y * s;
    *a = ( wisp_vec3 ){ 1.0f + sign * n.x * n.x * s, sign * t, -sign * n.x };
    *b = ( wisp_vec3 ){ t, sign + n.y * n.y * s, -n.y };
}

// Areas are equal where the square of the distance is uniform. In the plane a disc is a line across the root.
static wisp_vec3 draw_offset( const wisp_scene_scatter* scatter, wisp_random_key key, int target, int k,
                              wisp_vec3 direction, int dimension )
{
    float u = wisp_random_unit_float( key, (uint32_t)target, (uint32_t)k, DRAW_DISTANCE );
    if ( dimension == 2 )
    {
        float aside = scatter->radius * ( 2.0f * u - 1.0f );
        return ( wisp_vec3 ){ aside * direction.y, -aside * direction.x, 0.0f };
    }
    float turn = wisp_random_unit_float( key, (uint32_t)target, (uint32_t)k, DRAW_TURN );
    float distance = scatter->radius * sqrtf( u ), sine, cosine;
    trig_sincos( TWO_PI * turn, &sine, &cosine );
    float p = distance * cosine, q = distance * sine;
    wisp_vec3 a, b;
    across( direction, &a, &b );
    return ( wisp_vec3 ){ p * a.x + q * b.x, p * a.y + q * b.y, p * a.z + q * b.z };
}

// Makes the strands around one target, from vertex `at` on. @return the vertex after the last one
static int scatter_around( const wisp_scene_scatter* scatter, wisp_random_key key, const wisp_groom* source,
                           int target, int at, wisp_groom* out )
{
    const int first = source->offsets[target], count = source->offsets[target + 1] - first;
    const wisp_vec3* points = source->points + first;
    const wisp_vec3 direction = root_direction( points, count );
    for ( int k = 0; k < scatter->count; ++k )
    {
        wisp_vec3 offset = draw_offset( scatter, key, target, k, direction, source->dimension );
        out->offsets[target * scatter->count + k] = at;
        for ( int v = 0; v < count; ++v, ++at )
        {
            out->points[at] = ( wisp_vec3 ){ points[v].x + offset.x, points[v].y + offset.y, points[v].z + offset.z };
            if ( out->thickness )
            {
                out->thickness[at] = source->thickness[first + v];
            }
            if ( out->colour )
            {
                out->colour[at] = source->colour[first + v];
            }
        }
    }
    return at;
}

wisp_status wisp_scene_make_scatter( const wisp_scene_scatter* scatter, const wisp_groom* source, wisp_groom* out,
                                     wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    const int64_t strands = (int64_t)source->strand_count * scatter->count;
    const int64_t vertices = (int64_t)source->vertex_count * scatter->count;
    if ( strands > WISP_GROOM_MAX_GENERATED || vertices > WISP_GROOM_MAX_GENERATED )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%d strands around each of %d have %lld vertices, expected at most %d", scatter->count,
                          source->strand_count, (long long)vertices, WISP_GROOM_MAX_GENERATED );
    }
    int columns = ( source->thickness ? GROOM_THICKNESS : 0 ) | ( source->colour ? GROOM_COLOUR : 0 );
    WISP_TRY( groom_allocate( out, (int)strands, (int)vertices, columns, "scatter", error ) );
    const wisp_random_key key = wisp_random_make_key( scatter->seed, RANDOM_STREAM, 0 );
    int at = 0;
    for ( int target = 0; target < source->strand_count; ++target )
    {
        at = scatter_around( scatter, key, source, target, at, out );
    }
    out->offsets[strands] = at;
    out->dimension = source->dimension;
    return WISP_OK;
}

// ---- curves ----

// Curves through strands as they start: before the first step no pass has drawn any. What a curve is stands in
// guide_hair.h; this is the same cubic, so that the first frame of a recording fits those that follow.

static wisp_vec3 mix( float a, wisp_vec3 p, float b, wisp_vec3 q )
{
    return ( wisp_vec3 ){ a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z };
}

/// Control points of a cubic in Bezier form.
typedef struct cubic
{
    wisp_vec3 control[4];
} cubic;

static wisp_vec3 cubic_at( const cubic* c, float t )
{
    float s = 1.0f - t;
    return mix( 1.0f, mix( s * s * s, c->control[0], 3.0f * s * s * t, c->control[1] ), 1.0f,
                mix( 3.0f * s * t * t, c->control[2], t * t * t, c->control[3] ) );
}

// Half the way between neighbours; one-sided at the ends.
static wisp_vec3 tangent( const wisp_vec3* points, int count, int k )
{
    int before = k > 0 ? k - 1 : 0, after = k < count - 1 ? k + 1 : count - 1;
    float fraction = 1.0f / (float)( after - before );
    return mix( fraction, points[after], -fraction, points[before] );
}

static cubic smooth_cubic( const wisp_vec3* points, int count, int k )
{
    const float third = 1.0f / 3.0f;
    return ( cubic ){ { points[k], mix( 1.0f, points[k], third, tangent( points, count, k ) ),
                        mix( 1.0f, points[k + 1], -third, tangent( points, count, k + 1 ) ), points[k + 1] } };
}

// Four vertices that share their ends; what is left over at the tip is a quadratic or a line.
static cubic group_cubic( const wisp_vec3* points, int count, int group )
{
    const wisp_vec3* p = points + 3 * group;
    const float third = 1.0f / 3.0f, rest = 2.0f / 3.0f;
    switch ( count - 1 - 3 * group )
    {
        case 1:
            return ( cubic ){ { p[0], mix( rest, p[0], third, p[1] ), mix( third, p[0], rest, p[1] ), p[1] } };
        case 2:
            return ( cubic ){ { p[0], mix( third, p[0], rest, p[1] ), mix( rest, p[1], third, p[2] ), p[2] } };
        default:
            return ( cubic ){ { p[0], p[1], p[2], p[3] } };
    }
}

// A point next to a joint on the line through it along a tangent, as far from it as before.
static wisp_vec3 onto_tangent( wisp_vec3 joint, wisp_vec3 p, wisp_vec3 tangent, float sign )
{
    const wisp_vec3 d = mix( 1.0f, p, -1.0f, joint );
    const float length = sqrtf( tangent.x * tangent.x + tangent.y * tangent.y + tangent.z * tangent.z );
    const float distance = sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
    return length > 0.0f ? mix( 1.0f, joint, sign * distance / length, tangent ) : p;
}

// The same fours with one tangent at a joint, along the vertices at both sides of it.
static cubic joined_cubic( const wisp_vec3* points, int count, int group )
{
    const wisp_vec3* p = points + 3 * group;
    cubic c = group_cubic( points, count, group );
    if ( group > 0 )
    {
        c.control[1] = onto_tangent( c.control[0], c.control[1], mix( 1.0f, p[1], -1.0f, p[-1] ), 1.0f );
    }
    if ( 3 * group + 4 < count )
    {
        c.control[2] = onto_tangent( c.control[3], c.control[2], mix( 1.0f, p[4], -1.0f, p[2] ), -1.0f );
    }
    return c;
}

static int cubic_count( wisp_curve_kind kind, int vertices )
{
    return vertices < 2 ? 0 : kind == WISP_CURVE_CATMULL_ROM ? vertices - 1 : ( vertices + 1 ) / 3;
}

static int sample_count( const wisp_curves_def* def, int vertices )
{
    int cubics = cubic_count( def->kind, vertices );
    return cubics > 0 ? cubics * def->samples + 1 : 0;
}

static void draw( const wisp_curves_def* def, const wisp_vec3* points, int count, wisp_vec3* out )
{
    int cubics = cubic_count( def->kind, count );
    for ( int n = 0; n < cubics; ++n )
    {
        const cubic c =
            def->kind == WISP_CURVE_BEZIER ? joined_cubic( points, count, n ) : smooth_cubic( points, count, n );
        for ( int k = n == 0 ? 0 : 1; k <= def->samples; ++k )
        {
            *out++ = cubic_at( &c, (float)k / (float)def->samples );
        }
    }
}

wisp_status wisp_scene_make_curves( const wisp_curves_def* def, const wisp_groom* source, wisp_groom* out,
                                    wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    int64_t samples = 0;
    for ( int s = 0; s < source->strand_count; ++s )
    {
        samples += sample_count( def, source->offsets[s + 1] - source->offsets[s] );
    }
    if ( samples > WISP_GROOM_MAX_GENERATED )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "curves with %d samples per segment have %lld points, expected at most %d", def->samples,
                          (long long)samples, WISP_GROOM_MAX_GENERATED );
    }
    WISP_TRY( groom_allocate( out, source->strand_count, (int)samples, 0, "curves", error ) );
    int at = 0;
    for ( int s = 0; s < source->strand_count; ++s )
    {
        const int first = source->offsets[s], count = source->offsets[s + 1] - first;
        out->offsets[s] = at;
        draw( def, source->points + first, count, out->points + at );
        at += sample_count( def, count );
    }
    out->offsets[source->strand_count] = at;
    out->dimension = source->dimension;
    return WISP_OK;
}

// ---- places ----

// Copies move places by a step of their grid. A scene far from the origin of the world moves all of its places near it, so that floats
// keep their digits.

static void move( wisp_vec3* place, const double by[3] )
{
    place->x = (float)( (double)place->x + by[0] );
    place->y = (float)( (double)place->y + by[1] );
    place->z = (float)( (double)place->z + by[2] );
}

// Arrays are memory of the scene.
static void move_pins( wisp_scene_pins* pins, const double by[3] )
{
    for ( int i = 0; i < pins->box_count; ++i )
    {
        wisp_scene_box* box = (wisp_scene_box*)(uintptr_t)( pins->boxes + i );
        move( &box->lower, by );
        move( &box->upper, by );
    }
    for ( int i = 0; i < pins->nearest_count; ++i )
    {
        move( (wisp_vec3*)(uintptr_t)( pins->nearest + i ), by );
    }
    move( &pins->pivot, by );
}

static void move_path( const wisp_scene_path* path, const double by[3] )
{
    for ( int i = 0; i < path->count; ++i )
    {
        move( &( (wisp_scene_pose*)(uintptr_t)( path->poses + i ) )->pose.translation, by );
    }
}

static void move_surface( wisp_scene_surface* s, const double by[3] )
{
    move( &s->pose.translation, by );
    move_pins( &s->pins, by );
    for ( int g = 0; g < s->pin_group_count; ++g )
    {
        move_pins( &s->pin_groups[g], by );
    }
    move( &s->target_pivot, by );
    move( &s->frame_pivot, by );
    move( &s->outlet_nearest, by );
}

static void move_collider( wisp_scene_collider* c, const double by[3] )
{
    move( &c->def.pose.translation, by );
    move_path( &c->path, by );
}

// ---- the origin ----

// A multiple of 8 m: a scene that is moved by such has the bits that it had, if its first body is within 4 m of 0.
static double origin_near( float place )
{
    const double cell = 8.0, home = 16.0; // m
    return fabs( (double)place ) > home ? cell * rint( (double)place / cell ) : 0.0;
}

// What is made of another groom is in its place.
static void move_strands( wisp_scene_strands* s, const double by[3] )
{
    if ( !s->is_scattered && !s->is_curves )
    {
        move( &s->pose.translation, by );
    }
    move( &s->head_pivot, by );
    move( &s->frame_pivot, by );
    if ( s->has_cursor )
    {
        move( &s->frozen_hair.cursor, by );
    }
    move_path( &s->head, by );
}

// A plane is endless: it keeps its height above the new origin, and its point goes along. One that is moved is a body as others are.
static void move_plane( wisp_scene_collider* c )
{
    wisp_vec3* p = &c->def.pose.translation;
    if ( c->def.kind == WISP_COLLIDER_PLANE && c->path.count == 0 )
    {
        const wisp_vec3 n = wisp_quat_rotate( c->def.pose.rotation, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        const double height = (double)n.x * (double)p->x + (double)n.y * (double)p->y + (double)n.z * (double)p->z;
        *p = ( wisp_vec3 ){ (float)( height * (double)n.x ), (float)( height * (double)n.y ),
                            (float)( height * (double)n.z ) };
    }
}

void scene_find_origin( wisp_scene* scene )
{
    const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
    const wisp_vec3 first = scene->surface_count > 0   ? scene->surfaces[0].pose.translation
                            : scene->strands_count > 0 ? scene->strands[0].pose.translation
                                                       : none;
    scene->origin[0] = origin_near( first.x );
    scene->origin[1] = origin_near( first.y );
    scene->origin[2] = origin_near( first.z );
    const double by[3] = { -scene->origin[0], -scene->origin[1], -scene->origin[2] };
    if ( by[0] == 0.0 && by[1] == 0.0 && by[2] == 0.0 )
    {
        return;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        move_surface( &scene->surfaces[i], by );
        if ( scene->surfaces[i].boundary.eye_angle > 0.0f )
        {
            move( &scene->surfaces[i].boundary.eye, by );
        }
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        move_strands( &scene->strands[i], by );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        move_collider( &scene->colliders[i], by );
        move_plane( &scene->colliders[i] );
    }
    for ( int i = 0; i < scene->command_count; ++i )
    {
        move( &scene->commands[i].cursor, by );
    }
}

// ---- copies ----

// A list of entries that can be copied.
typedef struct copied
{
    const char* list; // its key
    size_t at;        // of the entries in a scene; their count is behind it
    size_t size;      // of an entry, which begins as scene_entry does
    size_t copies;    // of its wisp_scene_copies
    /// @param sum of entries so far, with copies @param vertices of them so far
    wisp_status ( *check )( scene_reader* r, int index, int64_t sum, int64_t* vertices );
    /// Make a copy of what the entry is now, somewhere else.
    wisp_status ( *make )( scene_reader* r, int source, const double by[3], void* out );
} copied;

// An array of its own for a copy. @param at the pointer to the array @return false without memory
static bool make_own( scene_reader* r, void* at, int count, size_t size )
{
    const void* from;
    memcpy( &from, at, sizeof from );
    void* own = count > 0 ? scene_take( r->scene, (size_t)count, size ) : NULL;
    if ( own )
    {
        memcpy( own, from, (size_t)count * size );
        memcpy( at, &own, sizeof own );
    }
    return own || count == 0;
}

static bool make_own_pins( scene_reader* r, wisp_scene_pins* pins )
{
    return make_own( r, &pins->boxes, pins->box_count, sizeof *pins->boxes ) &&
           make_own( r, &pins->nearest, pins->nearest_count, sizeof *pins->nearest );
}

static wisp_status check_surface( scene_reader* r, int index, int64_t sum, int64_t* vertices )
{
    const wisp_scene_surface* s = &r->scene->surfaces[index];
    *vertices += s->copies.count * scene_surface_vertices( r->scene, index );
    return sum <= WISP_SCENE_MAX_SURFACES && *vertices <= WISP_SCENE_MAX_VERTICES
               ? WISP_OK
               : scene_refuse( r->source, s->line, s->column, "surfaces",
                               "got %lld surfaces of %lld vertices with this one's copies, expected at most %d of %d",
                               (long long)sum, (long long)*vertices, WISP_SCENE_MAX_SURFACES,
                               WISP_SCENE_MAX_VERTICES );
}

// A copy is an instance: it shares the fabric of the entry, or of the one that this shares.
static wisp_status make_surface( scene_reader* r, int source, const double by[3], void* out )
{
    wisp_scene_surface* s = out;
    s->mesh = scene_default_surface( r->scene->gravity ).mesh;
    s->instance_of = s->instance_of >= 0 ? s->instance_of : source;
    bool has_all =
        make_own( r, &s->pin_groups, s->pin_group_count, sizeof *s->pin_groups ) && make_own_pins( r, &s->pins );
    for ( int i = 0; i < s->pin_group_count && has_all; ++i )
    {
        has_all = make_own_pins( r, &s->pin_groups[i] );
    }
    if ( !has_all )
    {
        return scene_no_memory( r );
    }
    move_surface( s, by );
    return WISP_OK;
}

static wisp_status check_strands( scene_reader* r, int index, int64_t sum, int64_t* vertices )
{
    const wisp_scene_strands* s = &r->scene->strands[index];
    const char* other = s->is_scattered      ? "scatter"
                        : s->is_curves       ? "curves"
                        : s->has_ghosts      ? "ghosts"
                        : s->has_head        ? "head"
                        : s->on_surface >= 0 ? "on_surface"
                                             : NULL;
    *vertices = s->is_generated ? s->copies.count * scene_made_vertices( s ) : 0;
    if ( other && s->copies.count > 1 )
    {
        return scene_refuse( r->source, s->line, s->column, "strands", "'copies' is not possible with '%s'", other );
    }
    return sum <= WISP_SCENE_MAX_STRANDS && *vertices <= WISP_GROOM_MAX_GENERATED
               ? WISP_OK
               : scene_refuse( r->source, s->line, s->column, "strands",
                               "got %lld entries with copies, and %lld vertices of this one, expected at most %d and "
                               "%d",
                               (long long)sum, (long long)*vertices, WISP_SCENE_MAX_STRANDS,
                               WISP_GROOM_MAX_GENERATED );
}

static wisp_status make_strands( scene_reader* r, int source, const double by[3], void* out )
{
    (void)r;
    (void)source;
    move( &( (wisp_scene_strands*)out )->pose.translation, by );
    return WISP_OK;
}

static wisp_status check_collider( scene_reader* r, int index, int64_t sum, int64_t* vertices )
{
    (void)vertices;
    const wisp_scene_collider* c = &r->scene->colliders[index];
    return sum <= WISP_SCENE_MAX_COLLIDERS
               ? WISP_OK
               : scene_refuse( r->source, c->line, c->column, "colliders",
                               "got %lld entries with this one's copies, expected at most %d", (long long)sum,
                               WISP_SCENE_MAX_COLLIDERS );
}

static wisp_status make_collider( scene_reader* r, int source, const double by[3], void* out )
{
    (void)source;
    wisp_scene_collider* c = out;
    const bool has_all = make_own( r, &c->path.poses, c->path.count, sizeof *c->path.poses );
    if ( has_all )
    {
        move_collider( c, by );
    }
    return has_all ? WISP_OK : scene_no_memory( r );
}

#define COPIED( member, entry, check, make )                                                                         \
    {                                                                                                                \
#member, offsetof( wisp_scene, member ), sizeof( entry ), offsetof( entry, copies ), check, make             \
    }
static const copied KINDS[] = {
    COPIED( surfaces, wisp_scene_surface, check_surface, make_surface ),
    COPIED( strands, wisp_scene_strands, check_strands, make_strands ),
    COPIED( colliders, wisp_scene_collider, check_collider, make_collider ),
};

static wisp_status name_copy( scene_reader* r, const copied* kind, int number, void* out )
{
    scene_entry entry;
    memcpy( &entry, out, sizeof entry );
    entry.name = scene_print( r->scene, "%s-%d", entry.name, number );
    memcpy( out, &entry, sizeof entry );
    if ( !entry.name )
    {
        return scene_no_memory( r );
    }
    if ( strlen( entry.name ) > WISP_SCENE_MAX_NAME )
    {
        return scene_refuse( r->source, entry.line, entry.column, kind->list,
                             "the name of the copy '%s' has more than %d characters", entry.name,
                             WISP_SCENE_MAX_NAME );
    }
    const scene_name* taken = scene_find_name( r, entry.name );
    return taken
               ? scene_refuse( r->source, entry.line, entry.column, kind->list,
                               "the name of the copy '%s' is taken by the entry in line %d", entry.name, taken->line )
               : WISP_OK;
}

// Number k stands in row k / columns and column k % columns: in a line along the axes that have a spacing, else in a square.
static wisp_status make_copy( scene_reader* r, const copied* kind, const wisp_scene_copies* copies, int source, int k,
                              void* out )
{
    const wisp_vec3 step = copies->spacing;
    const bool has_rows = step.y != 0.0f || step.z != 0.0f;
    const int usual = step.x == 0.0f ? 1 : has_rows ? (int)ceil( sqrt( copies->count ) ) : copies->count;
    const int columns = copies->columns > 0 ? copies->columns : usual;
    const float column = (float)( k % columns ), row = (float)( k / columns );
    const double by[3] = { (double)( column * step.x ), (double)( row * step.y ), (double)( row * step.z ) };
    WISP_TRY( kind->make( r, source, by, out ) );
    return name_copy( r, kind, k + 1, out );
}

static wisp_status copy_list( scene_reader* r, const copied* kind )
{
    char* const place = (char*)r->scene + kind->at;
    char *from, *all = NULL;
    int count = 0;
    int64_t sum = 0, vertices = 0;
    memcpy( &from, place, sizeof from );
    memcpy( &count, place + sizeof from, sizeof count );
    for ( int i = 0; i < count; ++i )
    {
        sum += ( (const wisp_scene_copies*)(const void*)( from + (size_t)i * kind->size + kind->copies ) )->count;
        WISP_TRY( kind->check( r, i, sum, &vertices ) );
    }
    if ( sum == count )
    {
        return WISP_OK;
    }
    all = scene_take( r->scene, (size_t)sum, kind->size );
    if ( !all )
    {
        return scene_no_memory( r );
    }
    memcpy( all, from, (size_t)count * kind->size );
    char* out = all + (size_t)count * kind->size;
    for ( int i = 0; i < count; ++i )
    {
        const char* entry = all + (size_t)i * kind->size;
        wisp_scene_copies copies;
        memcpy( &copies, entry + kind->copies, sizeof copies );
        for ( int k = 1; k < copies.count; ++k, out += kind->size )
        {
            memcpy( out, entry, kind->size );
            WISP_TRY( make_copy( r, kind, &copies, i, k, out ) );
        }
    }
    count = (int)sum;
    memcpy( place, &all, sizeof all );
    memcpy( place + sizeof all, &count, sizeof count );
    return WISP_OK;
}

wisp_status scene_make_copies( scene_reader* r )
{
    for ( int i = 0; i < WISP_COUNT( KINDS ); ++i )
    {
        WISP_TRY( copy_list( r, &KINDS[i] ) );
    }
    return WISP_OK;
}
