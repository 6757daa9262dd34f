// Surfaces of a scene: meshes read or generated, fabrics cooked with exactly the data that their effects need,
// effects set.
#include "scene_calls.h"
#include "world_from_scene_parts.h"

#include "wisp/module/module.h"
#include "wisp/module/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Contents of a fabric: the union for all surfaces that share it.
enum
{
    NEEDS_BEND_LINKS = 1,
    NEEDS_HINGES = 2,
    NEEDS_TETHERS = 4,
    NEEDS_COARSE_SHEETS = 8,
};

// ---- meshes ----

static wisp_status tell_repairs( const scene_world* world, const wisp_mesh_repairs* repairs, const char* called,
                                 wisp_error* error )
{
    const int done = repairs->degenerates_dropped + repairs->duplicates_dropped + repairs->triangles_turned +
                     repairs->unreferenced_dropped + repairs->vertices_welded + repairs->triangles_flipped;
    if ( !called || done == 0 )
    {
        return WISP_OK;
    }
    char* text = NULL;
    size_t size = 0;
    FILE* lines = open_memstream( &text, &size );
    if ( lines )
    {
        wisp_mesh_print_repairs( lines, repairs, called );
    }
    if ( !lines || fclose( lines ) != 0 )
    {
        free( text );
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the report of its repairs" );
    }
    char* rest = NULL;
    for ( const char* line = strtok_r( text, "\n", &rest ); line; line = strtok_r( NULL, "\n", &rest ) )
    {
        scene_tell( world, WISP_LOG_WARNING, line );
    }
    free( text );
    return WISP_OK;
}

static wisp_status check_demands( const wisp_scene_mesh* source, const wisp_mesh* mesh, wisp_error* error )
{
    wisp_mesh_diagnostics report;
    WISP_TRY( wisp_mesh_examine( mesh, &report, error ) );
    return wisp_mesh_require( &report, source->demands, source->file ? source->file : "the mesh", error );
}

static wisp_status read_mesh( const wisp_scene_mesh* source, wisp_mesh* out, wisp_error* error )
{
    const wisp_scene_arrays* a = source->arrays;
    return source->is_generated ? wisp_mesh_generate( &source->generator, out, error )
           : a ? wisp_mesh_of_arrays( a->points, a->point_count, a->triangles, a->triangle_count, source->file, out,
                                      error )
               : wisp_mesh_read( source->file, out, error );
}

// Read or generate, repair, check and scale a mesh.
// @param world whose log receives warnings about repairs; may be null: stderr
// @param called start of a warning about repairs; null: no warning
// @param repairs receives the repairs, to be released; may be null
static wisp_status load_source( const scene_world* world, const wisp_scene_mesh* source, const char* called,
                                wisp_mesh* out, wisp_mesh_repairs* repairs, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    wisp_mesh_repairs done = { 0 };
    wisp_status status = read_mesh( source, out, error );
    if ( status == WISP_OK && source->repairs != 0 )
    {
        status = wisp_mesh_repair( out, source->repairs, source->weld_distance, &done, error );
    }
    if ( status == WISP_OK && source->demands != 0 )
    {
        status = check_demands( source, out, error );
    }
    status = status == WISP_OK ? tell_repairs( world, &done, called, error ) : status;
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
        wisp_mesh_repairs_release( &done );
        return status;
    }
    for ( int v = 0; v < out->vertex_count; ++v )
    {
        wisp_vec3* p = &out->points[v];
        *p = ( wisp_vec3 ){ source->scale * p->x, source->scale * p->y, source->scale * p->z };
    }
    if ( repairs )
    {
        *repairs = done;
    }
    else
    {
        wisp_mesh_repairs_release( &done );
    }
    return WISP_OK;
}

// In the mesh's own frame.
static wisp_status load_mesh( const scene_world* world, const wisp_scene* scene, int surface, wisp_mesh* out,
                              wisp_mesh_repairs* repairs, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    char called[240];
    snprintf( called, sizeof called, "%.120s:%d:%d: surface '%s'", scene->name, entry->line, entry->column,
              entry->name );
    wisp_error cause = { 0 };
    wisp_status status =
        load_source( world, &entry->mesh, world && world->is_quiet ? NULL : called, out, repairs, &cause );
    return status == WISP_OK ? WISP_OK
                             : SCENE_FAIL_AT( scene, surfaces, surface, "surface", status, cause.message, error );
}

static void place_points( wisp_vec3* points, int count, wisp_transform pose )
{
    for ( int v = 0; v < count; ++v )
    {
        points[v] = wisp_transform_to_world( pose, points[v] );
    }
}

wisp_status scene_surface_mesh( const wisp_scene* scene, int surface, wisp_mesh* out, wisp_error* error )
{
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    int source = entry->instance_of >= 0 ? entry->instance_of : surface;
    WISP_TRY( load_mesh( NULL, scene, source, out, NULL, error ) );
    place_points( out->points, out->vertex_count, entry->pose );
    return WISP_OK;
}

// ---- fabrics ----

static unsigned char needs_of( const wisp_scene_surface* entry )
{
    const bool cloth = entry->has_cloth;
    const wisp_cloth_bending bending = entry->cloth.bending;
    unsigned char required = 0;
    if ( ( entry->has_balloon && !entry->has_membrane ) || ( cloth && bending == WISP_CLOTH_BENDING_LINKS ) )
    {
        required |= NEEDS_BEND_LINKS;
    }
    if ( cloth && ( bending == WISP_CLOTH_BENDING_DIHEDRAL || bending == WISP_CLOTH_BENDING_ISOMETRIC ) )
    {
        required |= NEEDS_HINGES;
    }
    if ( cloth && entry->cloth.coarse_substeps != 0 )
    {
        required |= NEEDS_COARSE_SHEETS;
    }
    return cloth && entry->cloth.tethers ? required | NEEDS_TETHERS : required;
}

wisp_fabric_def scene_fabric_def( const scene_world* world, int surface, const wisp_vec3* rest )
{
    const wisp_scene* scene = world->scene;
    const wisp_scene_surface* entry = &scene->surfaces[surface];
    const scene_world_surface* out = &world->surfaces[surface];
    unsigned char required = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const bool shares = i == surface || scene->surfaces[i].instance_of == surface;
        required |= shares ? needs_of( &scene->surfaces[i] ) : 0;
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = rest;
    def.triangles = out->mesh.triangles;
    def.vertex_count = out->mesh.vertex_count;
    def.triangle_count = out->mesh.triangle_count;
    def.attachments = out->pins;
    def.attachment_count = out->pin_count;
    def.bend_links = ( required & NEEDS_BEND_LINKS ) != 0;
    def.hinges = ( required & NEEDS_HINGES ) != 0;
    def.tethers = ( required & NEEDS_TETHERS ) != 0;
    def.coarse_sheets = ( required & NEEDS_COARSE_SHEETS ) != 0;
    def.lean = true;
    def.solve_order = entry->solve_order;
    def.tile_size = entry->tile_size;
    return def;
}

// Cooked in the mesh's own frame, so that instances do not depend on the start of their source.
static wisp_status cook( scene_world* world, int surface, const wisp_vec3* rest, wisp_error* error )
{
    wisp_fabric_def def = scene_fabric_def( world, surface, rest );
    def.workers = wisp_world_workers( world->world );
    wisp_error cause = { 0 };
    wisp_status status = wisp_fabric_cook( &def, NULL, &world->surfaces[surface].fabric, &cause );
    return status == WISP_OK
               ? WISP_OK
               : SCENE_FAIL_AT( world->scene, surfaces, surface, "surface", status, cause.message, error );
}

static wisp_status copy_points( const wisp_vec3* from, int count, wisp_vec3** out, wisp_error* error )
{
    *out = malloc( (size_t)count * sizeof **out + 1 );
    if ( !*out )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices", count );
    }
    memcpy( *out, from, (size_t)count * sizeof **out );
    return WISP_OK;
}

typedef wisp_status vertices_fn( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                                 scene_world_surface* s, wisp_error* error );

// Spare vertices are not pinned and not in a file: they become copies of others.
static wisp_status without_spares( vertices_fn* run, const wisp_scene* scene, int surface,
                                   const wisp_mesh_repairs* repairs, scene_world_surface* s, wisp_error* error )
{
    s->mesh.vertex_count -= s->spare_count;
    const wisp_status status = run( scene, surface, repairs, s, error );
    s->mesh.vertex_count += s->spare_count;
    return status;
}

// Places before the first step.
static wisp_status start_surface( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                                  scene_world_surface* s, wisp_error* error )
{
    WISP_TRY( without_spares( scene_start_load, scene, surface, repairs, s, error ) );
    scene_start_place( &scene->surfaces[surface], s );
    return scene_animation_load( scene, surface, s, error );
}

static wisp_status make_source( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    scene_world_surface* s = &world->surfaces[surface];
    wisp_status status = load_mesh( world, scene, surface, &s->mesh, &s->repairs, error );
    wisp_vec3* rest = NULL;
    status = status == WISP_OK ? scene_tearing_reserve( scene, surface, s, error ) : status;
    status = status == WISP_OK ? copy_points( s->mesh.points, s->mesh.vertex_count, &rest, error ) : status;
    if ( status == WISP_OK )
    {
        place_points( s->mesh.points, s->mesh.vertex_count, scene->surfaces[surface].pose );
        status = without_spares( scene_pins_find, scene, surface, &s->repairs, s, error );
    }
    status = status == WISP_OK ? cook( world, surface, rest, error ) : status;
    free( rest );
    return status == WISP_OK ? start_surface( scene, surface, &s->repairs, s, error ) : status;
}

static wisp_status make_instance( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const scene_world_surface* source = &world->surfaces[entry->instance_of];
    const wisp_fabric* fabric = source->fabric;
    scene_world_surface* s = &world->surfaces[surface];
    s->mesh.points = malloc( (size_t)fabric->vertex_count * sizeof( wisp_vec3 ) + 1 );
    if ( !s->mesh.points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices", fabric->vertex_count );
    }
    s->mesh.vertex_count = fabric->vertex_count;
    s->spare_count = source->spare_count;
    for ( int v = 0; v < fabric->vertex_count; ++v )
    {
        s->mesh.points[v] = fabric->rest[fabric->vertex_slot[v]];
    }
    place_points( s->mesh.points, s->mesh.vertex_count, entry->pose );
    wisp_fabric_retain( source->fabric );
    s->fabric = source->fabric;
    WISP_TRY( without_spares( scene_pins_find, world->scene, surface, &source->repairs, s, error ) );
    WISP_TRY( start_surface( world->scene, surface, &source->repairs, s, error ) );
    return scene_tearing_prepare( world, surface, error );
}

// ---- effects ----

static wisp_status add_particles( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    scene_world_surface* s = &world->surfaces[surface];
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = s->fabric;
    def.points = s->mesh.points;
    def.area_density = entry->area_density;
    def.vertex_mass = entry->vertex_mass;
    def.pins = s->pins;
    def.pin_count = s->pin_count;
    def.spare_count = s->spare_count;
    def.gravity = entry->gravity;
    WISP_TRY( wisp_add_surface( world->world, &def, &s->entity ) );
    WISP_TRY( scene_maps_set( world, surface, true, error ) );
    scene_surface_weigh( entry, s, world->world );
    WISP_TRY( wisp_set_damping( world->world, s->entity, entry->damping ) );
    WISP_TRY( wisp_set_strain_limit( world->world, s->entity, entry->strain_limit[0], entry->strain_limit[1] ) );
    WISP_TRY( wisp_set_substeps( world->world, s->entity, entry->substeps ) );
    return wisp_set_velocity( world->world, s->entity, entry->velocity, entry->angular_velocity );
}

// Quad links replace the mesh's own; the surface copies them.
wisp_status scene_implicit_set( scene_world* world, int surface )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const int source = entry->instance_of >= 0 ? entry->instance_of : surface;
    const wisp_mesh_generator* generator = &world->scene->surfaces[source].mesh.generator;
    wisp_implicit_cloth_def def = entry->implicit;
    wisp_quad_pairs pairs = { 0 };
    wisp_error cause = { 0 };
    if ( entry->has_quad_links &&
         wisp_quad_pairs_make( generator->columns, generator->rows, &pairs, &cause ) != WISP_OK )
    {
        return wisp_world_fail( world->world, cause.status, "%s", cause.message );
    }
    if ( entry->has_quad_links )
    {
        def.stretch_pairs = pairs.stretch;
        def.stretch_pair_count = pairs.stretch_count;
        def.bend_pairs = pairs.bend;
        def.bend_pair_count = pairs.bend_count;
    }
    wisp_status status = wisp_set_implicit_cloth( world->world, world->surfaces[surface].entity, &def );
    wisp_quad_pairs_release( &pairs );
    return status;
}

static wisp_status dress( scene_world* world, int surface, const wisp_balloon_def* balloon )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    wisp_entity entity = world->surfaces[surface].entity;
    wisp_world* w = world->world;
    WISP_TRY( entry->has_membrane ? wisp_set_membrane( w, entity, &entry->membrane ) : WISP_OK );
    WISP_TRY( entry->has_cloth ? wisp_set_cloth( w, entity, &entry->cloth ) : WISP_OK );
    WISP_TRY( entry->has_balloon ? wisp_set_balloon( w, entity, balloon ) : WISP_OK );
    WISP_TRY( entry->has_implicit ? scene_implicit_set( world, surface ) : WISP_OK );
    WISP_TRY( entry->has_collision ? wisp_set_collision( w, entity, &entry->collision ) : WISP_OK );
    WISP_TRY( entry->has_contact ? wisp_set_contact( w, entity, &entry->contact ) : WISP_OK );
    WISP_TRY( scene_held_set( world, surface ) );
    WISP_TRY( entry->has_boundary ? wisp_set_boundary( w, entity, &entry->boundary ) : WISP_OK );
    return scene_tearing_set( world, surface, NULL );
}

static wisp_status request( scene_world* world, int surface )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    wisp_entity entity = world->surfaces[surface].entity;
    const struct
    {
        bool requested;
        wisp_component component;
    } columns[] = {
        { entry->request_points, WISP_SURFACE_POINTS },     { entry->request_normals, WISP_SURFACE_NORMALS },
        { entry->request_strain, WISP_POINT_STRAIN },       { entry->request_speed, WISP_POINT_SPEED },
        { entry->request_motion_stats, WISP_MOTION_STATS },
    };
    for ( int i = 0; i < WISP_COUNT( columns ); ++i )
    {
        WISP_TRY( columns[i].requested ? wisp_request( world->world, entity, columns[i].component ) : WISP_OK );
    }
    if ( entry->request_stats )
    {
        WISP_TRY( entry->has_balloon ? wisp_request_balloon_stats( world->world, entity, true )
                                     : wisp_request_implicit_cloth_stats( world->world, entity, true ) );
    }
    if ( entry->request_contacts )
    {
        WISP_TRY( wisp_request_collision_stats( world->world, entity, true ) );
    }
    return WISP_OK;
}

static wisp_status add_effects( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    const scene_world_surface* s = &world->surfaces[surface];
    const int source = scene->surfaces[surface].instance_of;
    const wisp_mesh_repairs* repairs = source >= 0 ? &world->surfaces[source].repairs : &s->repairs;
    wisp_balloon_def balloon;
    WISP_TRY( scene_outlet_find( scene, surface, repairs, &s->mesh, &balloon, error ) );
    wisp_error of_map = { 0 }; // names the line of a map
    wisp_status status = add_particles( world, surface, &of_map );
    status = status == WISP_OK ? dress( world, surface, &balloon ) : status;
    status = status == WISP_OK ? scene_maps_set( world, surface, false, &of_map ) : status;
    status = status == WISP_OK ? request( world, surface ) : status;
    if ( of_map.status != WISP_OK )
    {
        return wisp_fail( error, of_map.status, "%s", of_map.message );
    }
    return status == WISP_OK ? WISP_OK
                             : SCENE_FAIL_AT( scene, surfaces, surface, "surface", status,
                                              wisp_world_message( world->world ), error );
}

// ---- all surfaces ----

// The scene's own meshes were counted when it was read; those of files are counted only here.
static wisp_status count_vertices( const scene_world* world, int surface, int64_t* sum, wisp_error* error )
{
    *sum += world->surfaces[surface].mesh.vertex_count;
    if ( *sum <= WISP_SCENE_MAX_VERTICES )
    {
        return WISP_OK;
    }
    char message[100];
    snprintf( message, sizeof message, "got %lld vertices in the surfaces up to this one, expected at most %d",
              (long long)*sum, WISP_SCENE_MAX_VERTICES );
    return SCENE_FAIL_AT( world->scene, surfaces, surface, "surface", WISP_BAD_INPUT, message, error );
}

void scene_tell_attachment( scene_world* world, int surface, int group, int to )
{
    const scene_world_surface* s = &world->surfaces[surface];
    const scene_world_pins* pins = &s->groups[group];
    if ( to >= 0 )
    {
        scene_call_begin( world, "wisp_attach_pins", s->entity );
        scene_call_vertices( world, pins->vertices, pins->count );
        scene_call_value( world, c_whole( pins->count ) );
        scene_call_entity( world, world->surfaces[to].entity );
        scene_call_end( world, "" );
    }
}

wisp_status scene_attach_pins( scene_world* world, int surface, int group, int to )
{
    const scene_world_surface* s = &world->surfaces[surface];
    const scene_world_pins* pins = &s->groups[group];
    scene_tell_attachment( world, surface, group, to );
    return wisp_attach_pins( world->world, s->entity, pins->vertices, pins->count, world->surfaces[to].entity );
}

// What needs other surfaces: they all exist by now.
static wisp_status connect( scene_world* world, int surface, wisp_error* error )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const scene_world_surface* s = &world->surfaces[surface];
    wisp_status status = WISP_OK;
    for ( int g = 0; g < s->group_count && status == WISP_OK; ++g )
    {
        const int to = scene_pins_entry( entry, g )->attached_to;
        status = to < 0 ? WISP_OK : scene_attach_pins( world, surface, g, to );
    }
    if ( status == WISP_OK && entry->has_collider )
    {
        wisp_collider_def def = entry->collider;
        wisp_entity collider;
        def.kind = WISP_COLLIDER_SURFACE;
        def.surface = s->entity;
        status = wisp_add_collider( world->world, &def, &collider );
    }
    return status == WISP_OK ? WISP_OK
                             : SCENE_FAIL_AT( world->scene, surfaces, surface, "surface", status,
                                              wisp_world_message( world->world ), error );
}

wisp_status scene_surfaces_add( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    world->surfaces = io_get( &world->memory, (size_t)scene->surface_count * sizeof *world->surfaces );
    if ( !world->surfaces )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its surfaces", scene->name );
    }
    int64_t sum = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        WISP_TRY( scene->surfaces[i].instance_of >= 0 ? make_instance( world, i, error )
                                                      : make_source( world, i, error ) );
        WISP_TRY( count_vertices( world, i, &sum, error ) );
        WISP_TRY( add_effects( world, i, error ) );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        WISP_TRY( connect( world, i, error ) );
    }
    return WISP_OK;
}

void scene_surfaces_release( scene_world* world )
{
    for ( int i = 0; world->surfaces && i < world->scene->surface_count; ++i )
    {
        scene_world_surface* s = &world->surfaces[i];
        wisp_mesh_release( &s->mesh );
        wisp_mesh_repairs_release( &s->repairs );
        wisp_fabric_release( s->fabric );
        scene_animation_release( s->animation );
        io_release( &s->memory );
    }
    for ( int i = 0; world->colliders && i < world->scene->collider_count; ++i )
    {
        wisp_mesh_release( &world->colliders[i].mesh );
    }
}

// ---- colliders ----

// Colliders of a scene: bodies for the world, and meshes that pictures and recordings can show of them.

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
    WISP_TRY( wisp_convex_create( out->points, out->vertex_count, NULL, &convex, error ) );
    const int32_t* triangles;
    const int count = wisp_convex_triangles( convex, &triangles );
    wisp_mesh hull = { 0 };
    wisp_status status = take_mesh( out->points, out->vertex_count, triangles, count, &hull, error );
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
            return load_source( world, &entry->mesh, world->is_quiet ? NULL : called, out, NULL, error );
        case WISP_COLLIDER_TAPERED_CAPSULE:
            return show_tapered( &entry->def, out, error );
        case WISP_COLLIDER_CONVEX:
        {
            const wisp_status status =
                load_source( world, &entry->mesh, world->is_quiet ? NULL : called, out, NULL, error );
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
        return SCENE_FAIL_AT( world->scene, colliders, collider, "collider", status, cause.message, error );
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
    return status == WISP_OK ? WISP_OK
                             : SCENE_FAIL_AT( world->scene, colliders, collider, "collider", status,
                                              wisp_world_message( world->world ), error );
}

wisp_status scene_colliders_add( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    world->colliders = io_get( &world->memory, (size_t)scene->collider_count * sizeof *world->colliders );
    if ( !world->colliders )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its colliders", scene->name );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        WISP_TRY( add_collider( world, i, error ) );
    }
    return WISP_OK;
}
