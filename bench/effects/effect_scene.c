#include "effects/effect_scene.h"

#include "groom.h"
#include "mesh.h"

#include "balloon/balloon.h"
#include "boundary/boundary.h"
#include "environment/environment.h"
#include "cloth/cloth.h"
#include "collision/collision.h"
#include "contact/contact.h"
#include "frozen_hair/frozen_hair.h"
#include "guide_hair/guide_hair.h"
#include "implicit_cloth/implicit_cloth.h"
#include "strand_appearance/strand_appearance.h"
#include "strands/strands.h"

#include <limits.h>
#include <string.h>

#define GRAVITY ( ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f } )
#define STRAND_SPACING 0.0005f ///< m
#define GUIDES_FRACTION 8      ///< ghosts per guide

typedef wisp_status host_fn( wisp_world* world, const effect_size* size, effect_scene* out, wisp_error* error );
typedef wisp_status set_fn( wisp_world* world, const effect_scene* scene );
typedef wisp_status tell_fn( wisp_world* world, const effect_scene* scene, int step );

struct effect_parts
{
    host_fn* add_host;         ///< add the entity of the effect
    const wisp_module* beside; ///< move the host, or null
    set_fn* set;               ///< the effect itself
    tell_fn* tell;             ///< commands before each step, or null
};

// ---- entities of the effects ----

static wisp_entity* begin_entity( effect_scene* out, wisp_component shown )
{
    out->shown[out->entity_count] = shown;
    return out->entities + out->entity_count++;
}

// Number of held vertices, from the first one on.
enum
{
    LOOSE = 0,
    HUNG = 2,
    HELD = INT_MAX, // all of them: a floor
};

static wisp_status pin_first( wisp_world* world, wisp_entity surface, int count )
{
    wisp_status status = WISP_OK;
    for ( int32_t i = 0; i < count && status == WISP_OK; ++i )
    {
        status = wisp_pin( world, surface, &i, 1 );
    }
    return status;
}

static wisp_status add_surface( wisp_world* world, const wisp_mesh* mesh, int pin_count, effect_scene* out,
                                wisp_error* error )
{
    wisp_fabric_def cook = wisp_default_fabric_def();
    cook.points = mesh->points;
    cook.triangles = mesh->triangles;
    cook.vertex_count = mesh->vertex_count;
    cook.triangle_count = mesh->triangle_count;
    wisp_surface_def def = wisp_default_surface_def();
    wisp_status status = wisp_fabric_cook( &cook, NULL, &def.fabric, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_entity* entity = begin_entity( out, WISP_SURFACE_POINTS );
    status = wisp_add_surface( world, &def, entity );
    const int pins = pin_count < mesh->vertex_count ? pin_count : mesh->vertex_count;
    status = status == WISP_OK ? pin_first( world, *entity, pins ) : status;
    status = status == WISP_OK ? wisp_set_gravity( world, *entity, GRAVITY ) : status;
    status = status == WISP_OK ? wisp_request( world, *entity, WISP_SURFACE_POINTS ) : status;
    wisp_fabric_release( def.fabric );
    return status;
}

static wisp_status add_sheet( wisp_world* world, const effect_size* size, float height, int pin_count,
                              effect_scene* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = generator.rows = size->side;
    generator.spacing = 1.0f / (float)( size->side - 1 );
    wisp_mesh mesh;
    wisp_status status = wisp_mesh_generate( &generator, &mesh, error );
    for ( int i = 0; i < mesh.vertex_count && status == WISP_OK; ++i )
    {
        mesh.points[i].y += height;
    }
    status = status == WISP_OK ? add_surface( world, &mesh, pin_count, out, error ) : status;
    wisp_mesh_release( &mesh );
    return status;
}

static wisp_status host_sheet( wisp_world* world, const effect_size* size, effect_scene* out, wisp_error* error )
{
    return add_sheet( world, size, 1.0f, HUNG, out, error );
}

static wisp_status host_loose_sheet( wisp_world* world, const effect_size* size, effect_scene* out,
                                     wisp_error* error )
{
    return add_sheet( world, size, 0.01f, LOOSE, out, error );
}

// A sheet a little above a static one, so that contact has the same work in every step.
static wisp_status host_two_sheets( wisp_world* world, const effect_size* size, effect_scene* out, wisp_error* error )
{
    const wisp_status status = add_sheet( world, size, 0.0f, HELD, out, error );
    return status == WISP_OK ? add_sheet( world, size, 0.3f / (float)size->side, LOOSE, out, error ) : status;
}

static wisp_status host_sphere( wisp_world* world, const effect_size* size, effect_scene* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = size->level;
    wisp_mesh mesh;
    wisp_status status = wisp_mesh_generate( &generator, &mesh, error );
    status = status == WISP_OK ? add_surface( world, &mesh, LOOSE, out, error ) : status;
    wisp_mesh_release( &mesh );
    return status;
}

static wisp_status add_strands( wisp_world* world, int count, effect_scene* out, wisp_error* error )
{
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_WAVY, 2 );
    generator.strand_count = count;
    generator.vertices_per_strand = 20;
    generator.spacing = STRAND_SPACING;
    wisp_groom groom;
    wisp_status status = wisp_groom_generate( &generator, &groom, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = groom.points;
    def.offsets = groom.offsets;
    def.strand_count = groom.strand_count;
    def.dimension = groom.dimension;
    wisp_entity* entity = begin_entity( out, WISP_STRAND_POINTS );
    status = wisp_add_strands( world, &def, entity );
    wisp_groom_release( &groom );
    return status == WISP_OK ? wisp_request( world, *entity, WISP_STRAND_POINTS ) : status;
}

static wisp_status host_strands( wisp_world* world, const effect_size* size, effect_scene* out, wisp_error* error )
{
    return add_strands( world, size->strands, out, error );
}

static wisp_status move_strands( wisp_world* world, wisp_entity strands )
{
    const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    return wisp_set_strand_dynamics( world, strands, &def );
}

// Guides that move, and hair for ghosts.
static wisp_status host_guides( wisp_world* world, const effect_size* size, effect_scene* out, wisp_error* error )
{
    wisp_status status = add_strands( world, ( size->strands + GUIDES_FRACTION - 1 ) / GUIDES_FRACTION, out, error );
    status = status == WISP_OK ? move_strands( world, out->entities[0] ) : status;
    return status == WISP_OK ? add_strands( world, size->strands, out, error ) : status;
}

// ---- effects ----

static wisp_status set_balloon( wisp_world* world, const effect_scene* scene )
{
    wisp_balloon_def def = wisp_default_balloon_def();
    def.gas_ratio = 1.05f;
    return wisp_set_balloon( world, scene->entities[0], &def );
}

static wisp_status set_boundary( wisp_world* world, const effect_scene* scene )
{
    const wisp_boundary_def def = wisp_default_boundary_def();
    return wisp_set_boundary( world, scene->entities[0], &def );
}

static wisp_status tell_environment( wisp_world* world, const effect_scene* scene, int step )
{
    wisp_environment_def def = wisp_default_environment_def();
    def.temperature_celsius = step % 2 == 0 ? -10.0f : -5.0f;
    return wisp_set_environment( world, scene->entities[0], &def );
}

static wisp_status set_environment( wisp_world* world, const effect_scene* scene )
{
    const wisp_status status = tell_environment( world, scene, 0 );
    return status == WISP_OK ? wisp_request( world, scene->entities[0], WISP_STRAND_STIFFNESS ) : status;
}

static wisp_status set_cloth( wisp_world* world, const effect_scene* scene )
{
    wisp_cloth_def def = wisp_default_cloth_def();
    def.drag_coefficient = 1.0f;
    def.internal_damping = 0.5f;
    return wisp_set_cloth( world, scene->entities[0], &def );
}

static wisp_status set_collision( wisp_world* world, const effect_scene* scene )
{
    wisp_collider_def body = wisp_default_collider_def();
    body.kind = WISP_COLLIDER_PLANE;
    wisp_entity collider;
    const wisp_status status = wisp_add_collider( world, &body, &collider );
    const wisp_collision_def def = wisp_default_collision_def();
    return status == WISP_OK ? wisp_set_collision( world, scene->entities[0], &def ) : status;
}

static wisp_status set_contact( wisp_world* world, const effect_scene* scene )
{
    wisp_contact_def def = wisp_default_contact_def();
    def.self = false;
    const wisp_status status = wisp_set_contact( world, scene->entities[0], &def );
    return status == WISP_OK ? wisp_set_contact( world, scene->entities[1], &def ) : status;
}

static wisp_status tell_frozen_hair( wisp_world* world, const effect_scene* scene, int step )
{
    const wisp_vec3 cursor = { step % 2 == 0 ? 0.3f : -0.3f, -1.0f, 0.0f };
    return wisp_command_frozen_hair( world, scene->entities[0], cursor );
}

static wisp_status set_frozen_hair( wisp_world* world, const effect_scene* scene )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.reach = 10.0f;
    def.clump_radius = 4.0f * STRAND_SPACING;
    return wisp_set_frozen_hair( world, scene->entities[0], &def );
}

static wisp_status set_guide_hair( wisp_world* world, const effect_scene* scene )
{
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.targets = scene->entities[0];
    return wisp_set_ghosts( world, scene->entities[1], &def );
}

static wisp_status set_implicit_cloth( wisp_world* world, const effect_scene* scene )
{
    const wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    return wisp_set_implicit_cloth( world, scene->entities[0], &def );
}

static wisp_status tell_strand_appearance( wisp_world* world, const effect_scene* scene, int step )
{
    wisp_strand_appearance_def def = wisp_default_strand_appearance_def();
    def.root_width = step % 2 == 0 ? 80e-6f : 90e-6f;
    return wisp_set_strand_appearance( world, scene->entities[0], &def );
}

static wisp_status set_strand_appearance( wisp_world* world, const effect_scene* scene )
{
    wisp_status status = tell_strand_appearance( world, scene, 0 );
    status = status == WISP_OK ? wisp_request( world, scene->entities[0], WISP_POINT_WIDTH ) : status;
    return status == WISP_OK ? wisp_request( world, scene->entities[0], WISP_POINT_COLOUR ) : status;
}

static wisp_status set_strands( wisp_world* world, const effect_scene* scene )
{
    return move_strands( world, scene->entities[0] );
}

// ---- the list ----

static const effect_parts balloon_parts = { host_sphere, NULL, set_balloon, NULL };
static const effect_parts boundary_parts = { host_sphere, NULL, set_boundary, NULL };
static const effect_parts environment_parts = { host_strands, NULL, set_environment, tell_environment };
static const effect_parts cloth_parts = { host_sheet, NULL, set_cloth, NULL };
static const effect_parts collision_parts = { host_loose_sheet, NULL, set_collision, NULL };
static const effect_parts contact_parts = { host_two_sheets, NULL, set_contact, NULL };
static const effect_parts frozen_hair_parts = { host_strands, NULL, set_frozen_hair, tell_frozen_hair };
static const effect_parts guide_hair_parts = { host_guides, &wisp_strands_module, set_guide_hair, NULL };
static const effect_parts implicit_cloth_parts = { host_sheet, NULL, set_implicit_cloth, NULL };
static const effect_parts strand_appearance_parts = { host_strands, NULL, set_strand_appearance,
                                                      tell_strand_appearance };
static const effect_parts strands_parts = { host_strands, NULL, set_strands, NULL };

// A module without a scene does not compile, so no effect can be forgotten.
#define WISP_MODULE( name ) { #name, &wisp_##name##_module, &name##_parts },
static const effect ALL[] = {
#include "modules.inc"
};
#undef WISP_MODULE

_Static_assert( WISP_COUNT( ALL ) <= EFFECT_MODULES_MAX, "room for every module" );

const effect* effects_all( int* count )
{
    *count = WISP_COUNT( ALL );
    return ALL;
}

const effect* effects_find( const char* name )
{
    for ( int i = 0; i < WISP_COUNT( ALL ); ++i )
    {
        if ( strcmp( ALL[i].name, name ) == 0 )
        {
            return ALL + i;
        }
    }
    return NULL;
}

static bool acts( const wisp_module* module, const effect* const* effects, int count, bool is_on )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( ( is_on && effects[i]->module == module ) || effects[i]->parts->beside == module )
        {
            return true;
        }
    }
    return false;
}

int effects_modules( const effect* const* effects, int count, bool is_on, effect_registry registry,
                     const wisp_module** modules )
{
    int used = 0;
    for ( int i = 0; i < WISP_COUNT( ALL ); ++i )
    {
        if ( registry == EFFECT_EVERY || acts( ALL[i].module, effects, count, is_on ) )
        {
            modules[used++] = ALL[i].module;
        }
    }
    return used;
}

// ---- a scene ----

// An error of the world has a message; an error before the world exists has one already.
static wisp_status refuse( wisp_world* world, const effect* which, wisp_status status, wisp_error* error )
{
    const char* message = wisp_world_message( world );
    return message[0] != '\0' ? wisp_fail( error, status, "scene of %s: %s", which->name, message ) : status;
}

wisp_status effect_scene_add( const effect* which, const effect_size* size, bool is_on, wisp_world* world,
                              effect_scene* out, wisp_error* error )
{
    *out = ( effect_scene ){ .effect = which, .is_on = is_on };
    wisp_status status = which->parts->add_host( world, size, out, error );
    status = status == WISP_OK && is_on ? which->parts->set( world, out ) : status;
    return status == WISP_OK ? WISP_OK : refuse( world, which, status, error );
}

wisp_status effect_scene_tell( const effect_scene* scene, wisp_world* world, int step )
{
    tell_fn* tell = scene->effect->parts->tell;
    return tell != NULL && scene->is_on ? tell( world, scene, step ) : WISP_OK;
}

wisp_status effect_scene_hash( const effect_scene* scene, wisp_world* world, uint64_t* hash )
{
    *hash = 0;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->entity_count && status == WISP_OK; ++i )
    {
        uint64_t points;
        status = wisp_world_hash_column( world, scene->entities[i], scene->shown[i], &points );
        *hash = *hash * 0x9e3779b97f4a7c15u + points;
    }
    return status;
}

int effect_scene_vertices( const effect_scene* scene, wisp_world* world )
{
    int vertices = 0;
    for ( int i = 0; i < scene->entity_count; ++i )
    {
        wisp_view view;
        const wisp_status status = wisp_world_view( world, scene->entities[i], scene->shown[i], &view );
        vertices += status == WISP_OK ? view.count : 0;
    }
    return vertices;
}
