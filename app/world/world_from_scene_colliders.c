// Colliders of a scene: bodies for the world, and meshes that pictures and recordings can show of them.
#include "world_from_scene_parts.h"

#include "wisp/module/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static wisp_status fail_at_collider( const wisp_scene* scene, int collider, wisp_status status, const char* message,
                                     wisp_error* error )
{
    const wisp_scene_collider* entry = &scene->colliders[collider];
    return scene_fail_at( scene, entry->line, entry->column, "collider", entry->name, status, message, error );
}

// ---- meshes of shapes ----

static wisp_status take_mesh( const wisp_vec3* points, int point_count, const int32_t* triangles, int triangle_count,
                              wisp_mesh* out, wisp_error* error )
{
    out->points = malloc( (size_t)point_count * sizeof *out->points );
    out->triangles = malloc( (size_t)triangle_count * 3 * sizeof *out->triangles );
    if ( !out->points || !out->triangles )
    {
        wisp_mesh_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices", point_count );
    }
    memcpy( out->points, points, (size_t)point_count * sizeof *points );
    memcpy( out->triangles, triangles, (size_t)triangle_count * 3 * sizeof *triangles );
    out->vertex_count = point_count;
    out->triangle_count = triangle_count;
    return WISP_OK;
}

// A plane is infinite; a square of 2 m represents it.
static wisp_status show_plane( wisp_mesh* out, wisp_error* error )
{
    static const wisp_vec3 points[] = {
        { -1.0f, 0.0f, -1.0f }, { -1.0f, 0.0f, 1.0f }, { 1.0f, 0.0f, 1.0f }, { 1.0f, 0.0f, -1.0f }
    };
    static const int32_t triangles[] = { 0, 1, 2, 0, 2, 3 };
    return take_mesh( points, 4, triangles, 2, out, error );
}

// Corner c has bit 0, 1 and 2 of its number for x, y and z.
static wisp_status show_box( wisp_vec3 half, wisp_mesh* out, wisp_error* error )
{
    static const int32_t triangles[] = { 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                                         2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6 };
    wisp_vec3 points[8];
    for ( int c = 0; c < 8; ++c )
    {
        points[c] = ( wisp_vec3 ){ c & 1 ? half.x : -half.x, c & 2 ? half.y : -half.y, c & 4 ? half.z : -half.z };
    }
    return take_mesh( points, 8, triangles, 12, out, error );
}

static wisp_status show_round( const wisp_collider_def* def, wisp_mesh* out, wisp_error* error )
{
    // A capsule without a length is a sphere, and the generator of capsules needs a length.
    const bool capsule = def->kind == WISP_COLLIDER_CAPSULE && def->half_length >= 1e-6f;
    wisp_mesh_generator generator = wisp_default_mesh_generator( capsule ? WISP_MESH_CAPSULE : WISP_MESH_ICOSPHERE );
    generator.radius = def->radius;
    if ( capsule )
    {
        generator.length = 2.0f * def->half_length;
        generator.length_segments = 1;
    }
    return wisp_mesh_generate( &generator, out, error );
}

// Rings around the y axis and a pole at each end. A ring has the normals of one latitude; the one where the balls meet the cone
// is on both balls.
static wisp_status show_tapered( const wisp_collider_def* def, wisp_mesh* out, wisp_error* error )
{
    enum
    {
        RINGS = 16, // of each ball
        SEGMENTS = 24,
        POINTS = 2 * RINGS * SEGMENTS + 2,
        TRIANGLES = 2 * SEGMENTS * 2 * RINGS,
    };
    const double pi = 3.14159265358979323846, half = (double)def->half_length;
    const double difference = (double)def->bottom_radius - (double)def->top_radius;
    const double sine = half > 0.0 ? fmax( -1.0, fmin( 1.0, difference / ( 2.0 * half ) ) ) : 0.0;
    const double joint = fabs( difference ) < 2.0 * half ? asin( sine ) : ( difference > 0.0 ? 0.5 * pi : -0.5 * pi );
    wisp_vec3 points[POINTS];
    int32_t triangles[TRIANGLES][3];
    int count = 0;
    for ( int ring = 0; ring < 2 * RINGS; ++ring )
    {
        const bool is_top = ring >= RINGS;
        const double from = is_top ? joint : -0.5 * pi, to = is_top ? 0.5 * pi : joint;
        const double part = is_top ? (double)( ring - RINGS ) / RINGS : (double)( ring + 1 ) / RINGS;
        const double latitude = from + part * ( to - from );
        const double radius = (double)( is_top ? def->top_radius : def->bottom_radius );
        for ( int i = 0; i < SEGMENTS; ++i )
        {
            const double angle = 2.0 * pi * i / SEGMENTS, rho = radius * cos( latitude );
            points[ring * SEGMENTS + i] =
                ( wisp_vec3 ){ (float)( rho * cos( angle ) ),
                               (float)( ( is_top ? half : -half ) + radius * sin( latitude ) ),
                               (float)( -rho * sin( angle ) ) };
        }
    }
    points[POINTS - 2] = ( wisp_vec3 ){ 0.0f, (float)( -half - (double)def->bottom_radius ), 0.0f };
    points[POINTS - 1] = ( wisp_vec3 ){ 0.0f, (float)( half + (double)def->top_radius ), 0.0f };
    for ( int i = 0; i < SEGMENTS; ++i )
    {
        const int next = ( i + 1 ) % SEGMENTS, last = ( 2 * RINGS - 1 ) * SEGMENTS;
        memcpy( triangles[count++], ( int32_t[] ){ POINTS - 2, next, i }, sizeof *triangles );
        memcpy( triangles[count++], ( int32_t[] ){ POINTS - 1, last + i, last + next }, sizeof *triangles );
        for ( int ring = 0; ring + 1 < 2 * RINGS; ++ring )
        {
            const int32_t a = ring * SEGMENTS + i, b = ring * SEGMENTS + next;
            memcpy( triangles[count++], ( int32_t[] ){ a, b, b + SEGMENTS }, sizeof *triangles );
            memcpy( triangles[count++], ( int32_t[] ){ a, b + SEGMENTS, a + SEGMENTS }, sizeof *triangles );
        }
    }
    return take_mesh( points, POINTS, triangles[0], count, out, error );
}

// The hull in place of the mesh that it is made of.
static wisp_status show_hull( wisp_mesh* out, wisp_error* error )
{
    wisp_convex* convex;
    wisp_status status = wisp_convex_create( out->points, out->vertex_count, NULL, &convex, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int32_t* triangles;
    const int count = wisp_convex_triangles( convex, &triangles );
    wisp_mesh hull = { 0 };
    status = take_mesh( out->points, out->vertex_count, triangles, count, &hull, error );
    wisp_convex_release( convex );
    if ( status == WISP_OK )
    {
        wisp_mesh_release( out );
        *out = hull;
    }
    return status;
}

static wisp_status show_height_field( const wisp_collider_def* def, wisp_mesh* out, wisp_error* error )
{
    const int nx = def->height_count_x, nz = def->height_count_z;
    const size_t points = (size_t)nx * (size_t)nz, cells = (size_t)( nx - 1 ) * (size_t)( nz - 1 );
    out->points = malloc( points * sizeof *out->points );
    out->triangles = malloc( cells * 6 * sizeof *out->triangles );
    if ( !out->points || !out->triangles )
    {
        wisp_mesh_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d x %d heights", nx, nz );
    }
    int32_t* t = out->triangles;
    for ( int k = 0; k < nz; ++k )
    {
        for ( int i = 0; i < nx; ++i )
        {
            const int32_t a = k * nx + i;
            out->points[a] = ( wisp_vec3 ){ ( (float)i - 0.5f * (float)( nx - 1 ) ) * def->spacing, def->heights[a],
                                            ( (float)k - 0.5f * (float)( nz - 1 ) ) * def->spacing };
            if ( i + 1 < nx && k + 1 < nz )
            {
                const int32_t cell[] = { a, a + nx, a + nx + 1, a, a + nx + 1, a + 1 };
                memcpy( t, cell, sizeof cell );
                t += 6;
            }
        }
    }
    out->vertex_count = (int)points;
    out->triangle_count = (int)( 2 * cells );
    return WISP_OK;
}

static wisp_status find_mesh( const scene_world* world, int collider, wisp_mesh* out, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    const wisp_scene_collider* entry = &scene->colliders[collider];
    char called[240];
    snprintf( called, sizeof called, "%.120s:%d:%d: collider '%s'", scene->name, entry->line, entry->column,
              entry->name );
    switch ( entry->def.kind )
    {
        case WISP_COLLIDER_PLANE:
            return show_plane( out, error );
        case WISP_COLLIDER_BOX:
            return show_box( entry->def.half_extent, out, error );
        case WISP_COLLIDER_MESH:
            return scene_mesh_load( world, &entry->mesh, world->is_quiet ? NULL : called, out, NULL, error );
        case WISP_COLLIDER_TAPERED_CAPSULE:
            return show_tapered( &entry->def, out, error );
        case WISP_COLLIDER_CONVEX:
        {
            const wisp_status status =
                scene_mesh_load( world, &entry->mesh, world->is_quiet ? NULL : called, out, NULL, error );
            return status != WISP_OK ? status : show_hull( out, error );
        }
        case WISP_COLLIDER_HEIGHT_FIELD:
            return show_height_field( &entry->def, out, error );
        default:
            return show_round( &entry->def, out, error );
    }
}

// ---- bodies ----

static wisp_status add_collider( scene_world* world, int collider, wisp_error* error )
{
    scene_world_collider* c = &world->colliders[collider];
    wisp_error cause = { 0 };
    wisp_status status = find_mesh( world, collider, &c->mesh, &cause );
    if ( status != WISP_OK )
    {
        return fail_at_collider( world->scene, collider, status, cause.message, error );
    }
    wisp_collider_def def = world->scene->colliders[collider].def;
    c->pose = def.pose;
    if ( def.kind == WISP_COLLIDER_MESH || def.kind == WISP_COLLIDER_CONVEX )
    {
        def.points = c->mesh.points;
        def.triangles = c->mesh.triangles;
        def.point_count = c->mesh.vertex_count;
        def.triangle_count = c->mesh.triangle_count;
    }
    status = wisp_add_collider( world->world, &def, &c->entity );
    status = status == WISP_OK && world->scene->colliders[collider].request_reaction
                 ? wisp_request_reaction( world->world, c->entity, true )
                 : status;
    return status == WISP_OK
               ? WISP_OK
               : fail_at_collider( world->scene, collider, status, wisp_world_message( world->world ), error );
}

wisp_status scene_colliders_add( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    world->colliders = calloc( (size_t)scene->collider_count + 1, sizeof *world->colliders );
    if ( !world->colliders )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its colliders", scene->name );
    }
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->collider_count && status == WISP_OK; ++i )
    {
        status = add_collider( world, i, error );
    }
    return status;
}

void scene_colliders_release( scene_world* world )
{
    for ( int i = 0; world->colliders && i < world->scene->collider_count; ++i )
    {
        wisp_mesh_release( &world->colliders[i].mesh );
    }
    free( world->colliders );
}
