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

// ---- copies ----

enum
{
    MAX_NAME = 64,
};

// ---- where a copy is ----

static wisp_vec3 shift_of( const wisp_scene_copies* copies, int k )
{
    const int root = (int)ceil( sqrt( copies->count ) );
    const int columns = copies->columns > 0 ? copies->columns : root;
    const float column = (float)( k % columns ), row = (float)( k / columns );
    return ( wisp_vec3 ){ column * copies->spacing.x, row * copies->spacing.y, row * copies->spacing.z };
}

static wisp_vec3 moved( wisp_vec3 point, wisp_vec3 by )
{
    return ( wisp_vec3 ){ point.x + by.x, point.y + by.y, point.z + by.z };
}

// ---- names ----

// @return null without memory
static const char* name_copy( scene_reader* r, const char* name, int number )
{
    char* out = scene_take( r->scene, MAX_NAME + 12, 1 );
    if ( out )
    {
        snprintf( out, MAX_NAME + 12, "%s-%d", name, number );
    }
    return out;
}

static wisp_status check_name( const scene_reader* r, const char* name, int line, int column, const char* list )
{
    if ( strlen( name ) > MAX_NAME )
    {
        return scene_refuse( r->source, line, column, list, "the name of the copy '%s' has more than %d characters",
                             name, (int)MAX_NAME );
    }
    const scene_name* taken = scene_find_name( r, name );
    if ( taken )
    {
        return scene_refuse( r->source, line, column, list,
                             "the name of the copy '%s' is taken by the entry in line %d", name, taken->line );
    }
    return WISP_OK;
}

// ---- surfaces ----

static wisp_status move_pins( scene_reader* r, wisp_scene_pins* pins, wisp_vec3 by )
{
    wisp_scene_box* boxes = scene_take( r->scene, (size_t)pins->box_count + 1, sizeof *boxes );
    wisp_vec3* nearest = scene_take( r->scene, (size_t)pins->nearest_count + 1, sizeof *nearest );
    if ( !boxes || !nearest )
    {
        return scene_no_memory( r );
    }
    for ( int i = 0; i < pins->box_count; ++i )
    {
        boxes[i] = ( wisp_scene_box ){ moved( pins->boxes[i].lower, by ), moved( pins->boxes[i].upper, by ) };
    }
    for ( int i = 0; i < pins->nearest_count; ++i )
    {
        nearest[i] = moved( pins->nearest[i], by );
    }
    pins->boxes = boxes;
    pins->nearest = nearest;
    pins->pivot = moved( pins->pivot, by );
    return WISP_OK;
}

static wisp_status move_places( scene_reader* r, wisp_scene_surface* s, wisp_vec3 by )
{
    wisp_scene_pins* groups = scene_take( r->scene, (size_t)s->pin_group_count + 1, sizeof *groups );
    wisp_status status = groups ? move_pins( r, &s->pins, by ) : scene_no_memory( r );
    for ( int i = 0; i < s->pin_group_count && !status; ++i )
    {
        groups[i] = s->pin_groups[i];
        status = move_pins( r, &groups[i], by );
    }
    s->pin_groups = groups;
    s->target_pivot = moved( s->target_pivot, by );
    s->frame_pivot = moved( s->frame_pivot, by );
    s->outlet_nearest = moved( s->outlet_nearest, by );
    return status;
}

// A copy is an instance: it shares the fabric of the entry, or of the one that this shares.
static wisp_status copy_surface( scene_reader* r, int source, int k, wisp_scene_surface* out )
{
    const wisp_scene_surface* from = &r->scene->surfaces[source];
    const wisp_scene_surface none = scene_default_surface( r->scene->gravity );
    const wisp_vec3 by = shift_of( &from->copies, k );
    *out = *from;
    out->name = name_copy( r, from->name, k + 1 );
    if ( !out->name )
    {
        return scene_no_memory( r );
    }
    out->mesh = none.mesh;
    out->instance_of = from->instance_of >= 0 ? from->instance_of : source;
    out->pose.translation = moved( from->pose.translation, by );
    const wisp_status status = move_places( r, out, by );
    return status ? status : check_name( r, out->name, out->line, out->column, "surfaces" );
}

static wisp_status copy_surfaces( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    int64_t sum = 0, vertices = 0;
    int count = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_scene_surface* s = &scene->surfaces[i];
        const wisp_scene_mesh* mesh = &scene->surfaces[s->instance_of >= 0 ? s->instance_of : i].mesh;
        sum += s->copies.count;
        vertices += mesh->is_generated ? s->copies.count * scene_generator_vertices( &mesh->generator ) : 0;
        if ( sum > WISP_SCENE_MAX_SURFACES || vertices > WISP_SCENE_MAX_VERTICES )
        {
            return scene_refuse( r->source, s->line, s->column, "surfaces",
                                 "got %lld surfaces of %lld vertices with this one's copies, expected at most %d "
                                 "of %d",
                                 (long long)sum, (long long)vertices, WISP_SCENE_MAX_SURFACES,
                                 WISP_SCENE_MAX_VERTICES );
        }
    }
    if ( sum == scene->surface_count )
    {
        return WISP_OK;
    }
    wisp_scene_surface* all = scene_take( scene, (size_t)sum, sizeof *all );
    if ( !all )
    {
        return scene_no_memory( r );
    }
    memcpy( all, scene->surfaces, (size_t)scene->surface_count * sizeof *all );
    count = scene->surface_count;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        for ( int k = 1; k < all[i].copies.count; ++k )
        {
            const wisp_status status = copy_surface( r, i, k, &all[count++] );
            if ( status )
            {
                return status;
            }
        }
    }
    scene->surfaces = all;
    scene->surface_count = count;
    return WISP_OK;
}

// ---- strands ----

static wisp_status check_strands( const scene_reader* r, const wisp_scene_strands* s )
{
    const char* other = s->is_scattered      ? "scatter"
                        : s->is_curves       ? "curves"
                        : s->has_ghosts      ? "ghosts"
                        : s->has_head        ? "head"
                        : s->on_surface >= 0 ? "on_surface"
                                             : NULL;
    return other && s->copies.count > 1
               ? scene_refuse( r->source, s->line, s->column, "strands", "'copies' is not possible with '%s'", other )
               : WISP_OK;
}

static wisp_status copy_entry( scene_reader* r, const wisp_scene_strands* from, int k, wisp_scene_strands* out )
{
    *out = *from;
    out->name = name_copy( r, from->name, k + 1 );
    if ( !out->name )
    {
        return scene_no_memory( r );
    }
    out->pose.translation = moved( from->pose.translation, shift_of( &from->copies, k ) );
    return check_name( r, out->name, out->line, out->column, "strands" );
}

static wisp_status copy_strands( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    int64_t sum = 0;
    int count = 0;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        const wisp_status status = check_strands( r, s );
        const int64_t vertices = s->is_generated ? s->copies.count * scene_made_vertices( s ) : 0;
        sum += s->copies.count;
        if ( status )
        {
            return status;
        }
        if ( sum > WISP_SCENE_MAX_STRANDS || vertices > WISP_GROOM_MAX_GENERATED )
        {
            return scene_refuse( r->source, s->line, s->column, "strands",
                                 "got %lld entries with copies, and %lld vertices of this one, expected at most %d "
                                 "and %d",
                                 (long long)sum, (long long)vertices, WISP_SCENE_MAX_STRANDS,
                                 WISP_GROOM_MAX_GENERATED );
        }
    }
    if ( sum == scene->strands_count )
    {
        return WISP_OK;
    }
    wisp_scene_strands* all = scene_take( scene, (size_t)sum, sizeof *all );
    if ( !all )
    {
        return scene_no_memory( r );
    }
    memcpy( all, scene->strands, (size_t)scene->strands_count * sizeof *all );
    count = scene->strands_count;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        for ( int k = 1; k < all[i].copies.count; ++k )
        {
            const wisp_status status = copy_entry( r, &all[i], k, &all[count++] );
            if ( status )
            {
                return status;
            }
        }
    }
    scene->strands = all;
    scene->strands_count = count;
    return WISP_OK;
}

// ---- colliders ----

static wisp_status copy_collider( scene_reader* r, const wisp_scene_collider* from, int k, wisp_scene_collider* out )
{
    const wisp_vec3 by = shift_of( &from->copies, k );
    *out = *from;
    out->name = name_copy( r, from->name, k + 1 );
    wisp_scene_pose* poses = scene_take( r->scene, (size_t)from->path.count + 1, sizeof *poses );
    if ( !out->name || !poses )
    {
        return scene_no_memory( r );
    }
    for ( int i = 0; i < from->path.count; ++i )
    {
        poses[i] = from->path.poses[i];
        poses[i].pose.translation = moved( poses[i].pose.translation, by );
    }
    out->path.poses = poses;
    out->def.pose.translation = moved( from->def.pose.translation, by );
    return check_name( r, out->name, out->line, out->column, "colliders" );
}

static wisp_status copy_colliders( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    int64_t sum = 0;
    int count = scene->collider_count;
    for ( int i = 0; i < count; ++i )
    {
        const wisp_scene_collider* c = &scene->colliders[i];
        sum += c->copies.count;
        if ( sum > WISP_SCENE_MAX_COLLIDERS )
        {
            return scene_refuse( r->source, c->line, c->column, "colliders",
                                 "got %lld entries with this one's copies, expected at most %d", (long long)sum,
                                 WISP_SCENE_MAX_COLLIDERS );
        }
    }
    wisp_scene_collider* all = sum > count ? scene_take( scene, (size_t)sum, sizeof *all ) : scene->colliders;
    if ( !all || sum == count )
    {
        return all || sum == count ? WISP_OK : scene_no_memory( r );
    }
    memcpy( all, scene->colliders, (size_t)count * sizeof *all );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        for ( int k = 1; k < all[i].copies.count && !status; ++k )
        {
            status = copy_collider( r, &all[i], k, &all[count++] );
        }
    }
    scene->colliders = all;
    scene->collider_count = status ? scene->collider_count : count;
    return status;
}

wisp_status scene_make_copies( scene_reader* r )
{
    wisp_status status = copy_surfaces( r );
    status = status ? status : copy_strands( r );
    return status ? status : copy_colliders( r );
}
