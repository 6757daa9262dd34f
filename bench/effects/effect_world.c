#include "effects/effect_world.h"

#include "create.h"

#include "program_data.h"
#include "bench_world.h"
#include "text_tree.h"
#include "wisp/explain.h"

#include <stdlib.h>
#include <string.h>

// ---- scenes ----

wisp_status effects_read( effects* out, wisp_error* error )
{
    char path[1024];
    *out = ( effects ){ .count = 0 };
    program_data_path( "suites/effects.yaml", path, sizeof path );
    wisp_status status = suite_read( path, &out->suite, error );
    const wisp_module* const* modules = wisp_all_modules( &out->count );
    for ( int i = 0; i < out->count && status == WISP_OK; ++i )
    {
        const bool has_scene =
            2 * i + 1 < out->suite.row_count && strcmp( effects_name( out, i ), modules[i]->name ) == 0;
        status = has_scene ? WISP_OK
                           : wisp_fail( error, WISP_BAD_INPUT,
                                        "%s: expected a scene of '%s', and the same without it, as rows %d and %d",
                                        path, modules[i]->name, 2 * i, 2 * i + 1 );
    }
    return status;
}

void effects_release( effects* all )
{
    suite_release( &all->suite );
    all->count = 0;
}

const char* effects_name( const effects* all, int effect )
{
    return all->suite.rows[2 * effect].name;
}

int effects_find( const effects* all, const char* name )
{
    int found = all->count - 1;
    while ( found >= 0 && strcmp( effects_name( all, found ), name ) != 0 )
    {
        --found;
    }
    return found;
}

static void set_count( text_node* generator, const char* key, int count )
{
    if ( text_find( generator, key ) )
    {
        text_set_number( text_find( generator, key ), count );
    }
}

static void resize( text_node* body, const effect_size* size )
{
    text_node* generator = text_find( body, "generate" );
    const bool is_guides = strcmp( text_at( body, "name" ), "guides" ) == 0;
    set_count( generator, "columns", size->side );
    set_count( generator, "rows", size->side );
    set_count( generator, "level", size->level );
    set_count( generator, "strands", is_guides ? ( size->strands + 7 ) / 8 : size->strands );
}

// Append the bodies of a list to those of another scene. @return their number after that
static int append( const text_node* from, const char* list, const effect_size* size, text_node* to )
{
    const text_node* bodies = text_find( from, list );
    text_node* all = text_find( to, list );
    all = all ? all : text_put( to, list, text_list() );
    for ( int i = 0; bodies && i < bodies->count; ++i )
    {
        resize( text_add( all, text_copy( bodies->children[i] ) ), size );
    }
    return all->count;
}

static wisp_status gather( const effect_world_def* def, effect_world* out, text_node* scene, wisp_error* error )
{
    wisp_status status = WISP_OK;
    int strands = 0, surfaces = 0;
    for ( int i = 0; i < def->count && status == WISP_OK; ++i )
    {
        const suite_row* row = &def->all->suite.rows[2 * def->chosen[i] + ( def->is_on ? 0 : 1 )];
        text_node* own = NULL;
        status = text_parse( row->text, strlen( row->text ), row->name, &own, error );
        if ( status == WISP_OK )
        {
            effect_part* part = &out->parts[out->part_count++];
            *part = ( effect_part ){ .first_strands = strands, .first_surface = surfaces };
            part->end_strands = strands = append( own, "strands", &def->size, scene );
            part->end_surface = surfaces = append( own, "surfaces", &def->size, scene );
            (void)append( own, "colliders", &def->size, scene );
            (void)append( own, "seams", &def->size, scene );
        }
        text_release( own );
    }
    return status;
}

static wisp_status read_scenes( const effect_world_def* def, effect_world* out, wisp_error* error )
{
    text_node* scene = text_map();
    text_put( scene, "wisp", text_scalar( "1" ) );
    text_put( scene, "substeps", text_scalar( "4" ) );
    wisp_status status = gather( def, out, scene, error );
    char* text = text_write( scene, NULL );
    status = status == WISP_OK ? wisp_scene_parse( text, strlen( text ), "effects", &out->scene, error ) : status;
    free( text );
    text_release( scene );
    return status;
}

// ---- the world ----

// Scenes compute no stiffness, and without a request the environment has nothing to do.
static wisp_status request_stiffness( effect_world* world, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < world->scene.strands_count && status == WISP_OK; ++i )
    {
        status = world->scene.strands[i].has_environment
                     ? wisp_request( world->world.world, world->world.entities[i], WISP_STRAND_STIFFNESS )
                     : WISP_OK;
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( world->world.world, status, error );
}

wisp_status effect_world_open( const effect_world_def* def, effect_world** out, wisp_error* error )
{
    WISP_ASSERT( def->count <= EFFECT_SCENES_MAX );
    const scene_world_options options = {
        .workers = 1, .is_quiet = true, .allocator = def->allocator, .only_used_modules = def->only_used
    };
    effect_world* world = *out = calloc( 1, sizeof *world );
    wisp_status status =
        world ? read_scenes( def, world, error ) : wisp_fail( error, WISP_NO_MEMORY, "no memory for a world" );
    status = status == WISP_OK ? scene_world_create( &world->scene, &options, &world->world, error ) : status;
    status = status == WISP_OK ? request_stiffness( world, error ) : status;
    if ( status != WISP_OK )
    {
        effect_world_close( world );
        *out = NULL;
    }
    return status;
}

void effect_world_close( effect_world* world )
{
    if ( world )
    {
        if ( world->world.world )
        {
            scene_world_destroy( &world->world );
        }
        wisp_scene_release( &world->scene );
        free( world );
    }
}

// Scenes have no events of these values. New ones give the effects work in every step.
static wisp_status drive( effect_world* world )
{
    wisp_status status = WISP_OK;
    const bool is_even = world->world.next_step % 2 == 0;
    for ( int i = 0; i < world->scene.strands_count && status == WISP_OK; ++i )
    {
        const wisp_scene_strands* strands = &world->scene.strands[i];
        const wisp_entity entity = world->world.entities[i];
        wisp_environment_def environment = strands->environment;
        wisp_strand_appearance_def appearance = strands->appearance;
        environment.temperature_celsius = is_even ? -10.0f : -5.0f;
        appearance.root_width = is_even ? 80e-6f : 90e-6f;
        const wisp_vec3 cursor = { is_even ? 0.3f : -0.3f, -1.0f, 0.0f };
        status =
            strands->has_environment ? wisp_set_environment( world->world.world, entity, &environment ) : WISP_OK;
        status = status == WISP_OK && strands->has_appearance
                     ? wisp_set_strand_appearance( world->world.world, entity, &appearance )
                     : status;
        status = status == WISP_OK && strands->has_frozen_hair
                     ? wisp_command_frozen_hair( world->world.world, entity, cursor )
                     : status;
    }
    return status;
}

wisp_status effect_world_step( void* context, wisp_error* error )
{
    effect_world* world = context;
    const wisp_status status = drive( world );
    return status == WISP_OK ? scene_world_step( &world->world, error )
                             : bench_world_fail( world->world.world, status, error );
}

size_t effect_world_bytes( const effect_world* world )
{
    return wisp_world_memory( world->world.world ) - world->world.empty_bytes;
}

static wisp_status add_hash( effect_world* world, wisp_entity entity, wisp_component component, uint64_t* hash )
{
    uint64_t points = 0;
    const wisp_status status = wisp_world_hash_column( world->world.world, entity, component, &points );
    *hash = *hash * 0x9e3779b97f4a7c15u + points;
    return status;
}

wisp_status effect_world_hash( effect_world* world, int part, uint64_t* hash, wisp_error* error )
{
    const effect_part* p = &world->parts[part];
    wisp_status status = WISP_OK;
    *hash = 0;
    for ( int i = p->first_strands; i < p->end_strands && status == WISP_OK; ++i )
    {
        status = add_hash( world, world->world.entities[i], WISP_STRAND_POINTS, hash );
    }
    for ( int i = p->first_surface; i < p->end_surface && status == WISP_OK; ++i )
    {
        status = add_hash( world, world->world.surfaces[i].entity, WISP_SURFACE_POINTS, hash );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( world->world.world, status, error );
}

wisp_status effect_world_plan( effect_world* world, char* out, int* count, wisp_error* error )
{
    wisp_plan_info* report;
    const wisp_status status = wisp_world_explain( world->world.world, &report );
    out[0] = '\0';
    if ( status != WISP_OK )
    {
        return bench_world_fail( world->world.world, status, error );
    }
    size_t length = 0;
    for ( int i = 0; i < report->active_count; ++i )
    {
        const int more =
            snprintf( out + length, EFFECT_PLAN_MAX - length, "%s%s", i > 0 ? " " : "", report->passes[i].name );
        length += more > 0 ? (size_t)more : 0;
        WISP_ASSERT( length < EFFECT_PLAN_MAX );
    }
    if ( count != NULL )
    {
        *count = report->active_count;
    }
    wisp_plan_info_release( report );
    return WISP_OK;
}
