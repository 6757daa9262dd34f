// A scene as the C of a host: arrays of what its files and recipes make, and of each definition what is not as by default, by the tables
// that read scenes. Keys of a table are the members of its definition.
#include "host_source.h"

#include "scene_calls.h"
#include "scene_parts.h"
#include "world_from_scene_parts.h"

#include "wisp/fabric.h"
#include "wisp/module/definition.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

// ---- values ----

#define TEXT( value ) c_number( value ).text

// Write lines with a number in place of each #, and values as printf does.
WISP_PRINTF( 3, 4 ) static void write_lines( FILE* out, int number, const char* lines, ... )
{
    char format[1000], *end = format;
    for ( const char* c = lines; *c != '\0'; ++c )
    {
        WISP_ASSERT( end + 12 < format + sizeof( format ) );
        end += snprintf( end, 12, *c == '#' ? "%d" : "%c", *c == '#' ? number : *c );
    }
    va_list values;
    va_start( values, lines );
    vfprintf( out, format, values );
    va_end( values );
}

static size_t size_of_field( const scene_field* field )
{
    switch ( field->type )
    {
        case SCENE_BLOCK:
        case SCENE_SWITCH:
        case SCENE_EITHER:
            return sizeof( bool );
        case SCENE_VECTOR:
            return sizeof( wisp_vec3 );
        case SCENE_SEED:
            return sizeof( uint64_t );
        case SCENE_NUMBER:
        case SCENE_NUMBERS:
        case SCENE_WHOLE:
            return 4;
        case SCENE_CHOICE:
            return field->constants != NULL ? 4 : 0;
        default:
            return field->read == scene_read_layers ? sizeof( uint32_t ) : 0;
    }
}

// The constant of a choice. Where its word begins with what the constants are of, it is not said twice: WISP_CLOTH_BENDING_LINKS.
static c_text constant_of( const scene_field* field, int value )
{
    const char* word = field->choices[value].word;
    const bool is_twice = strncmp( word, "bend_", 5 ) == 0 && strstr( field->constants, "_BEND" ) != NULL;
    c_text t;
    snprintf( t.text, sizeof( t.text ), "%s%s", field->constants, is_twice ? word + 5 : word );
    for ( char* c = t.text; *c != '\0'; ++c )
    {
        *c = (char)toupper( (unsigned char)*c );
    }
    return t;
}

static c_text value_of( const scene_field* field, const void* at )
{
    c_text t;
    switch ( field->type )
    {
        case SCENE_BLOCK:
        case SCENE_SWITCH:
        case SCENE_EITHER:
            return c_switch( *(const bool*)at );
        case SCENE_VECTOR:
            return c_vector( *(const wisp_vec3*)at );
        case SCENE_CHOICE:
            return constant_of( field, *(const int*)at );
        case SCENE_SEED:
            snprintf( t.text, sizeof( t.text ), "%lluu", (unsigned long long)*(const uint64_t*)at );
            return t;
        case SCENE_NUMBER:
        case SCENE_NUMBERS:
            return c_number( *(const float*)at );
        default:
            snprintf( t.text, sizeof( t.text ), field->read == scene_read_layers ? "0x%xu" : "%d",
                      *(const unsigned*)at );
            return t;
    }
}

// ---- definitions ----

// A definition of a scene's entry: where it is, and what it is by default.
typedef struct definition
{
    size_t at, size; // in the entry
    const void *entry, *initial;
} definition;

// Write the values of a definition that are not those by default. What readers of their own make of an entry is the caller's.
// @param copy [d->size] the definition by default, which gets the values that are written; null: nothing keeps them
// @param out null: only the copy gets them
static void write_fields( FILE* out, const char* name, const scene_block* block, const definition* d, char* copy )
{
    for ( int i = 0; i < block->field_count; ++i )
    {
        const scene_field field = scene_field_at( block, i ), *f = &field;
        const size_t at = f->at, size = size_of_field( f );
        const char *value = (const char*)d->entry + at, *initial = (const char*)d->initial + at;
        const bool is_own = at >= d->at && at + size <= d->at + d->size && strcmp( f->key, "shape" ) != 0 &&
                            strcmp( f->key, "position" ) != 0;
        const bool is_stage = f->type == SCENE_BLOCK; // without its key it is off, in the library it is on
        if ( size > 0 && is_own && ( is_stage || memcmp( value, initial, size ) != 0 ) )
        {
            if ( copy != NULL )
            {
                memcpy( copy + ( at - d->at ), value, size );
            }
            if ( out != NULL )
            {
                fprintf( out, "    %s.%s = %s;\n", name, f->member != NULL ? f->member : f->key,
                         value_of( f, value ).text );
            }
        }
        if ( is_stage && is_own )
        {
            write_fields( out, name, f->block, d, copy );
        }
    }
}

// Whether the values that tables tell are all that a definition has besides those by default.
static bool is_told( const scene_block* block, const definition* d )
{
    char* copy = malloc( d->size );
    bool is = copy != NULL;
    if ( is )
    {
        memcpy( copy, (const char*)d->initial + d->at, d->size );
        write_fields( NULL, "", block, d, copy );
        is = memcmp( copy, (const char*)d->entry + d->at, d->size ) == 0;
    }
    free( copy );
    return is;
}

// Write a definition of this name.
static void write_definition( FILE* out, const char* type, const char* name, const scene_block* block,
                              const definition* d )
{
    fprintf( out, "    wisp_%s_def %s = wisp_default_%s_def();\n", type, name, type );
    write_fields( out, name, block, d, NULL );
}

static const scene_field* find_field( const scene_block* block, const char* key )
{
    const scene_field* found = NULL;
    for ( int i = 0; i < block->field_count && found == NULL; ++i )
    {
        found = strcmp( block->fields[i].key, key ) == 0 ? &block->fields[i] : NULL;
    }
    return found;
}

// Blocks of an entry that are effects of the library, in the order in which a scene sets them.
typedef struct effect
{
    const char *key, *type;
    size_t at, size;
} effect;

#define OF( entry, key, type, member )                                                                               \
    {                                                                                                                \
        key, type, offsetof( entry, member ), sizeof( ( (entry*)0 )->member )                                        \
    }
static const effect SURFACE_EFFECTS[] = {
    OF( wisp_scene_surface, "membrane", "membrane", membrane ),
    OF( wisp_scene_surface, "cloth", "cloth", cloth ),
    OF( wisp_scene_surface, "balloon", "balloon", balloon ),
    OF( wisp_scene_surface, "implicit", "implicit_cloth", implicit ),
    OF( wisp_scene_surface, "collision", "collision", collision ),
    OF( wisp_scene_surface, "contact", "contact", contact ),
    OF( wisp_scene_surface, "motion_constraints", "motion_constraints", motion_constraints ),
    OF( wisp_scene_surface, "frame", "moving_frame", frame ),
    OF( wisp_scene_surface, "sleep", "sleep", sleep ),
    OF( wisp_scene_surface, "detail", "detail", detail ),
    OF( wisp_scene_surface, "boundary", "boundary", boundary ),
    OF( wisp_scene_surface, "tearing", "tearing", tearing ),
    OF( wisp_scene_surface, "collider", NULL, collider ),
    OF( wisp_scene_surface, "animation", NULL, animation ),
    OF( wisp_scene_surface, "start", NULL, start ),
};
enum
{
    LOOKS = 3,   // effects of strands that come before surfaces, as in a scene
    DETAIL = 10, // that of all strands comes last
};
static const effect STRANDS_EFFECTS[] = {
    OF( wisp_scene_strands, "frozen_hair", "frozen_hair", frozen_hair ),
    OF( wisp_scene_strands, "environment", "environment", environment ),
    OF( wisp_scene_strands, "appearance", "strand_appearance", appearance ),
    OF( wisp_scene_strands, "dynamics", "strand_dynamics", dynamics ),
    OF( wisp_scene_strands, "grid", "strand_grid", grid ),
    OF( wisp_scene_strands, "frame", "moving_frame", frame ),
    OF( wisp_scene_strands, "ghosts", "ghosts", ghosts ),
    OF( wisp_scene_strands, "collision", "collision", collision ),
    OF( wisp_scene_strands, "contact", "contact", contact ),
    OF( wisp_scene_strands, "sleep", "sleep", sleep ),
    OF( wisp_scene_strands, "detail", "detail", detail ),
    OF( wisp_scene_strands, "scatter", NULL, scatter ),
    OF( wisp_scene_strands, "head", NULL, head ),
    OF( wisp_scene_strands, "tips", NULL, tips_path ),
};

static void write_outlet( FILE* out, const scene_world* world, int number, const char* name )
{
    const int source = world->scene->surfaces[number].instance_of;
    wisp_balloon_def balloon;
    const wisp_status status =
        scene_outlet_find( world->scene, number, &world->surfaces[source >= 0 ? source : number].repairs,
                           &world->surfaces[number].mesh, &balloon, NULL );
    for ( int i = 0; status == WISP_OK && i < balloon.outlet_count; ++i )
    {
        fprintf( out, "    %s.outlet[%s.outlet_count++] = %d;\n", name, name, (int)balloon.outlet[i] );
    }
}

// What tables do not tell of a definition.
static void write_special( FILE* out, const scene_world* world, bool is_surface, int number, const char* name,
                           const char* key )
{
    if ( strcmp( key, "frame" ) == 0 )
    {
        const wisp_vec3 pivot = is_surface ? world->surfaces[number].frame_pivot
                                           : scene_strand_frame_pivot( &world->scene->strands[number] );
        fprintf( out, "    %s.pose.translation = %s;\n", name, c_vector( pivot ).text );
    }
    if ( strcmp( key, "ghosts" ) == 0 )
    {
        fprintf( out, "    %s.targets = strands%d;\n    %s.between = %s;\n", name,
                 world->scene->strands[number].targets, name, world->scene->frames_per_step > 1 ? "true" : "false" );
    }
    if ( strcmp( key, "balloon" ) == 0 )
    {
        write_outlet( out, world, number, name );
    }
}

static void write_effects( FILE* out, const char* of, int number, const effect* effects, int count,
                           const scene_block* block, const void* entry, const void* initial,
                           const scene_world* world )
{
    for ( int i = 0; i < count; ++i )
    {
        const effect* e = effects + i;
        const scene_field* field = find_field( block, e->key );
        char name[40];
        if ( e->type != NULL && *( (const bool*)entry + field->at ) )
        {
            snprintf( name, sizeof( name ), "%s_%s%d", e->key, of, number );
            write_definition( out, e->type, name, field->block, &( definition ){ e->at, e->size, entry, initial } );
            write_special( out, world, block == &SCENE_SURFACE_BLOCK, number, name, e->key );
            fprintf( out, "    TRY( wisp_set_%s( world, %s%d, &%s ) );\n", e->type, of, number, name );
        }
    }
}

// ---- what it cannot express ----

// A block that is none of the effects, or an effect with more than its table tells, as a key. @return null: there is none
static const char* find_other( const scene_block* block, const void* entry, const void* initial,
                               const effect* effects, int count )
{
    const char* found = NULL;
    for ( int i = 0; i < block->field_count && found == NULL; ++i )
    {
        const scene_field* f = &block->fields[i];
        bool is_known = f->block == NULL || f->at == 0 || *( (const bool*)entry + f->at ) == false;
        for ( int k = 0; k < count && is_known == false; ++k )
        {
            const effect* e = effects + k;
            is_known = strcmp( e->key, f->key ) == 0 &&
                       ( e->type == NULL || is_told( f->block, &( definition ){ e->at, e->size, entry, initial } ) );
        }
        found = is_known ? NULL : f->key;
    }
    return found;
}

static const char* other_of_surface( const wisp_scene_surface* s )
{
    const wisp_scene_surface initial = scene_default_surface( s->gravity );
    wisp_scene_surface told = *s;
    told.balloon.outlet_count = 0; // those are written apart
    memset( told.balloon.outlet, 0, sizeof( told.balloon.outlet ) );
    return s->map_count > 0        ? "maps"
           : s->mass_ratio != 1.0f ? "mass_ratio"
           : s->has_quad_links
               ? "implicit.links"
               : find_other( &SCENE_SURFACE_BLOCK, &told, &initial, SURFACE_EFFECTS, WISP_COUNT( SURFACE_EFFECTS ) );
}

static const char* other_of_strands( const wisp_scene_strands* s )
{
    const wisp_scene_strands initial = scene_default_strands( wisp_default_surface_def().gravity );
    return s->mass_ratio != 1.0f ? "mass_ratio"
           : s->mass_count > 0   ? "dynamics.vertex_masses"
           : s->dynamics.pin_count > 0
               ? "dynamics.pins"
               : find_other( &SCENE_STRANDS_BLOCK, s, &initial, STRANDS_EFFECTS, WISP_COUNT( STRANDS_EFFECTS ) );
}

// An event whose calls take a whole definition.
static const char* other_of_event( const wisp_scene* scene, const wisp_scene_event* e )
{
    const wisp_scene_surface* s = e->surface >= 0 ? &scene->surfaces[e->surface] : NULL;
    const bool restarts = e->has_velocity || e->has_angular_velocity || e->has_gust || e->release;
    const bool looks_back = s != NULL && s->has_implicit && s->implicit.integrator == WISP_INTEGRATOR_BDF2;
    return e->has_detail ? "detail" : restarts && looks_back ? "velocity" : NULL;
}

// Refuse an entry for what this does not print, if there is any.
static wisp_status refuse( const wisp_scene* scene, int line, const char* what, wisp_error* error )
{
    return what == NULL ? WISP_OK
                        : wisp_fail( error, WISP_BAD_INPUT, "%s:%d: got '%s', which --host does not print",
                                     scene->name, line, what );
}

static wisp_status check( const wisp_scene* scene, wisp_error* error )
{
    for ( int i = 0; i < scene->command_count; ++i )
    {
        const wisp_scene_hair_event* e = &scene->commands[i];
        WISP_TRY( refuse( scene, e->line, e->changes ? "hair_events" : NULL, error ) );
    }
    for ( int i = 0; i < scene->event_count; ++i )
    {
        WISP_TRY( refuse( scene, scene->events[i].line, other_of_event( scene, &scene->events[i] ), error ) );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        WISP_TRY( refuse( scene, scene->strands[i].line, other_of_strands( &scene->strands[i] ), error ) );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        WISP_TRY( refuse( scene, scene->surfaces[i].line, other_of_surface( &scene->surfaces[i] ), error ) );
    }
    return WISP_OK;
}

// ---- arrays ----

static void write_point_array( FILE* out, const char* name, int number, const wisp_vec3* points, int count )
{
    fprintf( out, "static const wisp_vec3 %s%d[] = {\n", name, number );
    for ( int v = 0; v < count; ++v )
    {
        fprintf( out, "    { %s, %s, %s },\n", TEXT( points[v].x ), TEXT( points[v].y ), TEXT( points[v].z ) );
    }
    fputs( "};\n", out );
}

static void write_whole( FILE* out, const char* name, int number, const int32_t* values, int count )
{
    fprintf( out, "static const int32_t %s%d[] = {", name, number );
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, "%s%d,", i % 20 == 0 ? "\n    " : " ", (int)values[i] );
    }
    fputs( "\n};\n", out );
}

static wisp_status write_arrays( FILE* out, const scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_groom* g = &world->grooms[i];
        write_point_array( out, "strand_points", i, g->points, g->vertex_count );
        write_whole( out, "strand_offsets", i, g->offsets, g->strand_count + 1 );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const scene_world_surface* s = &world->surfaces[i];
        const wisp_fabric* f = s->fabric;
        write_point_array( out, "points", i, s->mesh.points, s->mesh.vertex_count );
        if ( s->pin_count > 0 )
        {
            write_whole( out, "pins", i, s->pins, s->pin_count );
        }
        if ( scene->surfaces[i].instance_of < 0 )
        {
            wisp_vec3* rest = malloc( (size_t)f->vertex_count * sizeof( *rest ) + 1 );
            if ( rest == NULL )
            {
                return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices", f->vertex_count );
            }
            for ( int v = 0; v < f->vertex_count; ++v )
            {
                rest[v] = f->rest[f->vertex_slot[v]];
            }
            const size_t bytes = (size_t)f->vertex_count * sizeof( *rest );
            if ( memcmp( rest, s->mesh.points, bytes ) == 0 )
            {
                fprintf( out, "#define rest%d points%d\n", i, i );
            }
            else
            {
                write_point_array( out, "rest", i, rest, f->vertex_count );
            }
            write_whole( out, "triangles", i, s->mesh.triangles, 3 * s->mesh.triangle_count );
            free( rest );
        }
    }
    for ( int i = 0; i < scene->seam_count; ++i )
    {
        const int count = 2 * scene->seams[i].pair_count;
        int32_t* pairs = malloc( (size_t)count * sizeof( *pairs ) + 1 );
        if ( pairs == NULL || scene_seam_pairs( world, &scene->seams[i], pairs, error ) != WISP_OK )
        {
            free( pairs );
            return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d vertices of a seam", count );
        }
        if ( count > 0 )
        {
            write_whole( out, "pairs", i, pairs, count );
        }
        free( pairs );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        const wisp_mesh* m = &world->colliders[i].mesh;
        const wisp_collider_def* d = &scene->colliders[i].def;
        if ( d->kind == WISP_COLLIDER_MESH || d->kind == WISP_COLLIDER_CONVEX )
        {
            write_point_array( out, "body_points", i, m->points, m->vertex_count );
            write_whole( out, "body_triangles", i, m->triangles, 3 * m->triangle_count );
        }
        if ( d->kind == WISP_COLLIDER_HEIGHT_FIELD )
        {
            fprintf( out, "static const float heights%d[] = {\n", i );
            for ( int h = 0; h < d->height_count_x * d->height_count_z; ++h )
            {
                fprintf( out, "    %s,\n", TEXT( d->heights[h] ) );
            }
            fputs( "};\n", out );
        }
    }
    return WISP_OK;
}

// ---- entities ----

static void write_requests( FILE* out, const char* of, int number, const bool* requested,
                            const char* const* components, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( requested[i] )
        {
            fprintf( out, "    TRY( wisp_request( world, %s%d, WISP_%s ) );\n", of, number, components[i] );
        }
    }
}

static void write_origin( FILE* out, const wisp_scene* scene, const char* of, int number )
{
    const double* at = scene->origin;
    if ( at[0] != 0.0 || at[1] != 0.0 || at[2] != 0.0 )
    {
        fprintf( out, "    TRY( wisp_set_origin( world, %s%d, ( const double[] ){ %.17g, %.17g, %.17g } ) );\n", of,
                 number, at[0], at[1], at[2] );
    }
}

// A call of one value that surfaces and strands have alike.
static void write_setting( FILE* out, const char* function, const char* of, int number, c_text value, bool is_set )
{
    if ( is_set )
    {
        fprintf( out, "    TRY( wisp_%s( world, %s%d, %s ) );\n", function, of, number, value.text );
    }
}

static void write_strands( FILE* out, const scene_world* world, int i )
{
    static const char* const COMPONENTS[] = { "STRAND_POINTS", "POINT_WIDTH", "POINT_COLOUR",
                                              "POINT_STRAIN",  "POINT_SPEED", "MOTION_STATS" };
    const wisp_scene_strands* s = &world->scene->strands[i];
    const wisp_scene_strands initial = scene_default_strands( wisp_default_surface_def().gravity );
    const bool requested[] = { s->request_points, s->request_width, s->request_colour,
                               s->request_strain, s->request_speed, s->request_motion_stats };
    write_lines( out, i,
                 "\n    // %s\n"
                 "    wisp_strands_def strands_def# = wisp_default_strands_def();\n"
                 "    strands_def#.points = strand_points#;\n"
                 "    strands_def#.offsets = strand_offsets#;\n"
                 "    strands_def#.strand_count = COUNT( strand_offsets# ) - 1;\n"
                 "    strands_def#.dimension = %d;\n"
                 "    TRY( wisp_add_strands( world, &strands_def#, &strands# ) );\n",
                 s->name, world->grooms[i].dimension );
    write_effects( out, "strands", i, STRANDS_EFFECTS, LOOKS, &SCENE_STRANDS_BLOCK, s, &initial, world );
    write_requests( out, "strands", i, requested, COMPONENTS, WISP_COUNT( COMPONENTS ) );
}

// After surfaces and colliders, as in a scene.
static void write_dynamics( FILE* out, const scene_world* world, int i )
{
    const wisp_scene_strands* s = &world->scene->strands[i];
    const wisp_scene_strands initial = scene_default_strands( wisp_default_surface_def().gravity );
    if ( s->has_ghosts && s->has_frozen_hair )
    {
        write_lines( out, i, "    TRY( wisp_request( world, strands#, WISP_STRAND_POSED ) );\n" );
    }
    write_effects( out, "strands", i, STRANDS_EFFECTS + LOOKS, DETAIL - LOOKS, &SCENE_STRANDS_BLOCK, s, &initial,
                   world );
    write_setting( out, "set_substeps", "strands", i, c_whole( s->substeps ), s->substeps > 0 );
    write_setting( out, "set_max_speed", "strands", i, c_number( s->max_speed ), s->max_speed < INFINITY );
    if ( s->has_tips )
    {
        write_lines( out, i,
                     "    for ( int i = 0; i < COUNT( strand_offsets# ) - 1; ++i )\n    {\n"
                     "        TRY( wisp_hold_strand_tip( world, strands#, i, %s ) );\n    }\n",
                     value_of( find_field( &SCENE_TIPS_BLOCK, "hold" ), &s->tips_hold ).text );
    }
    write_setting( out, "request_collision_stats", "strands", i, c_switch( true ), s->request_contacts );
    if ( s->on_surface >= 0 )
    {
        write_lines( out, i, "    TRY( wisp_root_strands( world, strands#, surface%d ) );\n", s->on_surface );
    }
}

static void write_motion( FILE* out, const scene_world* world )
{
    const wisp_scene* scene = world->scene;
    const wisp_scene_strands initial = scene_default_strands( wisp_default_surface_def().gravity );
    for ( int i = 0; i < 2 * scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i % scene->strands_count];
        if ( i < scene->strands_count ? s->has_dynamics : s->has_ghosts )
        {
            write_dynamics( out, world, i % scene->strands_count );
        }
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        write_effects( out, "strands", i, STRANDS_EFFECTS + DETAIL, 1, &SCENE_STRANDS_BLOCK, &scene->strands[i],
                       &initial, world );
        write_origin( out, scene, "strands", i );
    }
}

static void write_fabric( FILE* out, const scene_world* world, int i )
{
    const wisp_fabric_def def = scene_fabric_def( world, i, NULL ), initial = wisp_default_fabric_def();
    const struct
    {
        const char* name;
        int value, initial;
    } members[] = {
        { "bend_links", def.bend_links, initial.bend_links },
        { "hinges", def.hinges, initial.hinges },
        { "tethers", def.tethers, initial.tethers },
        { "coarse_sheets", def.coarse_sheets, initial.coarse_sheets },
        { "lean", def.lean, initial.lean },
        { "tile_size", def.tile_size, initial.tile_size },
    };
    write_lines( out, i,
                 "    wisp_fabric_def fabric_def# = wisp_default_fabric_def();\n"
                 "    fabric_def#.points = rest#;\n"
                 "    fabric_def#.vertex_count = COUNT( rest# );\n"
                 "    fabric_def#.triangles = triangles#;\n"
                 "    fabric_def#.triangle_count = COUNT( triangles# ) / 3;\n" );
    if ( def.attachment_count > 0 )
    {
        write_lines( out, i,
                     "    fabric_def#.attachments = pins#;\n"
                     "    fabric_def#.attachment_count = COUNT( pins# );\n" );
    }
    for ( int k = 0; k < WISP_COUNT( members ); ++k )
    {
        if ( members[k].value != members[k].initial )
        {
            fprintf( out, "    fabric_def%d.%s = %d;\n", i, members[k].name, members[k].value );
        }
    }
    if ( def.solve_order != initial.solve_order )
    {
        write_lines( out, i, "    fabric_def#.solve_order = %s;\n",
                     value_of( find_field( &SCENE_SURFACE_BLOCK, "solve_order" ), &def.solve_order ).text );
    }
    write_lines( out, i, "    TRY( wisp_fabric_cook( &fabric_def#, NULL, &fabrics[#], NULL ) );\n" );
}

static void write_surface( FILE* out, const scene_world* world, int i )
{
    static const char* const COMPONENTS[] = { "SURFACE_POINTS", "SURFACE_NORMALS", "POINT_STRAIN", "POINT_SPEED",
                                              "MOTION_STATS" };
    static const char* const MEMBERS[] = { "area_density", "vertex_mass", "gravity" };
    const wisp_scene_surface* s = &world->scene->surfaces[i];
    const wisp_scene_surface initial = scene_default_surface( wisp_default_surface_def().gravity );
    const bool requested[] = { s->request_points, s->request_normals, s->request_strain, s->request_speed,
                               s->request_motion_stats };
    const wisp_vec3 v = s->velocity, w = s->angular_velocity;
    fprintf( out, "\n    // %s\n", s->name );
    if ( s->instance_of < 0 )
    {
        write_fabric( out, world, i );
    }
    write_lines( out, i,
                 "    wisp_surface_def surface_def# = wisp_default_surface_def();\n"
                 "    surface_def#.fabric = fabrics[%d];\n"
                 "    surface_def#.points = points#;\n",
                 s->instance_of < 0 ? i : s->instance_of );
    if ( world->surfaces[i].pin_count > 0 )
    {
        write_lines( out, i,
                     "    surface_def#.pins = pins#;\n"
                     "    surface_def#.pin_count = COUNT( pins# );\n" );
    }
    if ( world->surfaces[i].spare_count > 0 )
    {
        fprintf( out, "    surface_def%d.spare_count = %d;\n", i, world->surfaces[i].spare_count );
    }
    for ( int k = 0; k < WISP_COUNT( MEMBERS ); ++k )
    {
        const scene_field* f = find_field( &SCENE_SURFACE_BLOCK, MEMBERS[k] );
        if ( memcmp( (const char*)s + f->at, (const char*)&initial + f->at, size_of_field( f ) ) != 0 )
        {
            write_lines( out, i, "    surface_def#.%s = %s;\n", MEMBERS[k],
                         value_of( f, (const char*)s + f->at ).text );
        }
    }
    write_lines( out, i, "    TRY( wisp_add_surface( world, &surface_def#, &surface# ) );\n" );
    write_setting( out, "set_damping", "surface", i, c_number( s->damping ), s->damping > 0.0f );
    if ( s->strain_limit[0] > 0.0f || s->strain_limit[1] < INFINITY )
    {
        write_lines( out, i, "    TRY( wisp_set_strain_limit( world, surface#, %s, %s ) );\n",
                     TEXT( s->strain_limit[0] ), TEXT( s->strain_limit[1] ) );
    }
    write_setting( out, "set_substeps", "surface", i, c_whole( s->substeps ), s->substeps > 0 );
    if ( v.x != 0.0f || v.y != 0.0f || v.z != 0.0f || w.x != 0.0f || w.y != 0.0f || w.z != 0.0f )
    {
        write_lines( out, i, "    TRY( wisp_set_velocity( world, surface#, %s, %s ) );\n", c_vector( v ).text,
                     c_vector( w ).text );
    }
    write_effects( out, "surface", i, SURFACE_EFFECTS, WISP_COUNT( SURFACE_EFFECTS ), &SCENE_SURFACE_BLOCK, s,
                   &initial, world );
    write_setting( out, "set_max_speed", "surface", i, c_number( s->max_speed ), s->max_speed < INFINITY );
    write_requests( out, "surface", i, requested, COMPONENTS, WISP_COUNT( COMPONENTS ) );
    write_setting( out, s->has_balloon ? "request_balloon_stats" : "request_implicit_cloth_stats", "surface", i,
                   c_switch( true ), s->request_stats );
    write_setting( out, "request_collision_stats", "surface", i, c_switch( true ), s->request_contacts );
}

// What tables of colliders leave to readers of their own.
static void write_body( FILE* out, const char* name, const wisp_collider_def* d )
{
    const c_text kind = d->kind == WISP_COLLIDER_SURFACE
                            ? ( c_text ){ "WISP_COLLIDER_SURFACE" }
                            : value_of( find_field( &SCENE_COLLIDER_BLOCKS[d->kind], "shape" ), &d->kind );
    fprintf( out,
             "    %s.kind = %s;\n"
             "    %s.static_friction = %s, %s.kinetic_friction = %s;\n"
             "    %s.pose = %s;\n",
             name, kind.text, name, TEXT( d->static_friction ), name, TEXT( d->kinetic_friction ), name,
             c_transform( d->pose ).text );
}

static void write_seam( FILE* out, const wisp_scene* scene, int i )
{
    const wisp_scene_seam *s = &scene->seams[i], initial = scene_default_seam();
    char name[40];
    snprintf( name, sizeof( name ), "seam_def%d", i );
    fputs( "\n", out );
    write_definition( out, "seam", name, &SCENE_SEAM_BLOCK,
                      &( definition ){ offsetof( wisp_scene_seam, def ), sizeof( s->def ), s, &initial } );
    fprintf( out, "    %s.a = surface%d, %s.b = surface%d;\n", name, s->surfaces[0], name, s->surfaces[1] );
    if ( s->pair_count > 0 )
    {
        write_lines( out, i, "    seam_def#.pairs = pairs#;\n    seam_def#.pair_count = COUNT( pairs# ) / 2;\n" );
    }
    write_lines( out, i,
                 "    wisp_entity seam#;\n"
                 "    TRY( wisp_add_seam( world, &seam_def#, &seam# ) );\n" );
}

static void write_surface_collider( FILE* out, const wisp_scene* scene, int i )
{
    const wisp_scene_surface* s = &scene->surfaces[i];
    const wisp_scene_surface initial = scene_default_surface( s->gravity );
    char name[40];
    snprintf( name, sizeof( name ), "surface_collider%d", i );
    wisp_collider_def def = s->collider;
    def.kind = WISP_COLLIDER_SURFACE;
    fputs( "\n", out );
    write_definition(
        out, "collider", name, &SCENE_SURFACE_COLLIDER_BLOCK,
        &( definition ){ offsetof( wisp_scene_surface, collider ), sizeof( s->collider ), s, &initial } );
    write_body( out, name, &def );
    write_lines( out, i,
                 "    surface_collider#.surface = surface#;\n"
                 "    wisp_entity of_surface#;\n"
                 "    TRY( wisp_add_collider( world, &surface_collider#, &of_surface# ) );\n" );
}

static void write_collider( FILE* out, const wisp_scene* scene, int i )
{
    const wisp_scene_collider* c = &scene->colliders[i];
    const wisp_scene_collider initial = scene_default_collider();
    char name[40];
    snprintf( name, sizeof( name ), "collider_def%d", i );
    fprintf( out, "\n    // %s\n", c->name );
    write_definition( out, "collider", name, &SCENE_COLLIDER_BLOCKS[c->def.kind],
                      &( definition ){ offsetof( wisp_scene_collider, def ), sizeof( c->def ), c, &initial } );
    write_body( out, name, &c->def );
    if ( c->def.kind == WISP_COLLIDER_MESH || c->def.kind == WISP_COLLIDER_CONVEX )
    {
        write_lines( out, i,
                     "    collider_def#.points = body_points#;\n"
                     "    collider_def#.point_count = COUNT( body_points# );\n"
                     "    collider_def#.triangles = body_triangles#;\n"
                     "    collider_def#.triangle_count = COUNT( body_triangles# ) / 3;\n" );
    }
    if ( c->def.kind == WISP_COLLIDER_HEIGHT_FIELD )
    {
        write_lines( out, i,
                     "    collider_def#.heights = heights#;\n"
                     "    collider_def#.height_count_x = %d, collider_def#.height_count_z = %d;\n",
                     c->def.height_count_x, c->def.height_count_z );
    }
    write_lines( out, i, "    TRY( wisp_add_collider( world, &collider_def#, &collider# ) );\n" );
    write_setting( out, "request_reaction", "collider", i, c_switch( true ), c->request_reaction );
}

// ---- the program ----

static const char HEAD[] = "\n"
                           "#include <wisp/attachments.h>\n"
                           "#include <wisp/balloon.h>\n"
                           "#include <wisp/boundary.h>\n"
                           "#include <wisp/create.h>\n"
                           "#include <wisp/detail.h>\n"
                           "#include <wisp/environment.h>\n"
                           "#include <wisp/fabric.h>\n"
                           "#include <wisp/frozen_hair.h>\n"
                           "#include <wisp/guide_hair.h>\n"
                           "#include <wisp/implicit_cloth.h>\n"
                           "#include <wisp/membrane.h>\n"
                           "#include <wisp/motion_constraints.h>\n"
                           "#include <wisp/moving_frame.h>\n"
                           "#include <wisp/seams.h>\n"
                           "#include <wisp/sleep.h>\n"
                           "#include <wisp/strand_appearance.h>\n"
                           "#include <wisp/strands.h>\n"
                           "#include <wisp/tearing.h>\n"
                           "\n"
                           "#include <math.h>\n"
                           "#include <stdio.h>\n"
                           "\n"
                           "#define COUNT( array ) ( (int)( sizeof( array ) / sizeof( ( array )[0] ) ) )\n"
                           "#define TRY( call )                                                              \\\n"
                           "    do                                                                         \\\n"
                           "    {                                                                          \\\n"
                           "        const wisp_status status = ( call );                                   \\\n"
                           "        if ( status != WISP_OK )                                               \\\n"
                           "            return status;                                                     \\\n"
                           "    } while ( 0 )\n"
                           "\n";

static void declare( FILE* out, const char* of, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, "%s%s%d%s", i == 0 ? "static wisp_entity " : ", ", of, i, i == count - 1 ? ";\n" : "" );
    }
}

// What moves pins, colliders and heads, and what events change.
static bool has_calls( const wisp_scene* scene )
{
    bool has = scene->event_count + scene->command_count > 0;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        const wisp_scene_strands* s = &scene->strands[i];
        has = has || s->head.count + s->frame_path.count > 0 || s->has_tips;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_scene_surface* s = &scene->surfaces[i];
        has = has || s->target_path.count + s->frame_path.count + s->gas_ratio_keyframe_count > 0 || s->has_animation;
        for ( int g = 0; g <= s->pin_group_count; ++g )
        {
            has = has || scene_pins_entry( s, g )->path.count > 0;
        }
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        has = has || scene->colliders[i].path.count > 0;
    }
    return has;
}

// Run the scene, and write the calls that it makes before its steps: a function a step, and a table of them.
static wisp_status write_calls( FILE* out, scene_world* world, wisp_error* error )
{
    const int steps = world->scene->steps;
    bool* calls = calloc( (size_t)steps + 1, sizeof( *calls ) );
    wisp_status status = calls != NULL ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "out of memory for steps" );
    world->calls = out;
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        status = scene_world_step( world, error );
        calls[step] = world->last_call == step;
    }
    fputs( world->last_call >= 0 ? "    return WISP_OK;\n}\n" : "", out );
    fprintf( out, "\nstatic wisp_status ( *const BEFORE[%d] )( wisp_world* ) = {\n", steps + 1 );
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        if ( calls[step] )
        {
            fprintf( out, "    [%d] = before_%d,\n", step, step );
        }
    }
    fprintf( out, "    [%d] = NULL,\n};\n", steps );
    free( calls );
    return status;
}

static void write_world( FILE* out, scene_world* world )
{
    const wisp_scene *scene = world->scene, initial = scene_defaults();
    fputs( "\n", out );
    declare( out, "strands", scene->strands_count );
    declare( out, "surface", scene->surface_count );
    declare( out, "collider", scene->collider_count );
    fprintf( out, "\nstatic wisp_status make( wisp_world* world )\n{\n    wisp_fabric* fabrics[%d] = { NULL };\n",
             scene->surface_count + 1 );
    if ( scene->has_contact )
    {
        fputs( "    wisp_contact_settings settings = wisp_default_contact_settings();\n", out );
        write_fields( out, "settings", &SCENE_WORLD_CONTACT_BLOCK,
                      &( definition ){ offsetof( wisp_scene, contact ), sizeof( scene->contact ), scene, &initial },
                      NULL );
        fputs( "    TRY( wisp_set_contact_settings( world, &settings ) );\n", out );
    }
    if ( scene->request_contact_stats || scene->request_intersections )
    {
        fprintf( out, "    TRY( wisp_request_contact_stats( world, true, %s ) );\n",
                 scene->request_intersections ? "true" : "false" );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        write_strands( out, world, i );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        write_surface( out, world, i );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        world->calls = out;
        world->last_call = world->next_step; // these are no calls of a step
        for ( int g = 0; g < world->surfaces[i].group_count; ++g )
        {
            scene_tell_attachment( world, i, g, scene_pins_entry( &scene->surfaces[i], g )->attached_to );
        }
        world->calls = NULL;
        world->last_call = -1;
        if ( scene->surfaces[i].has_collider )
        {
            write_surface_collider( out, scene, i );
        }
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        write_collider( out, scene, i );
    }
    for ( int i = 0; i < scene->seam_count; ++i )
    {
        write_seam( out, scene, i );
    }
    write_motion( out, world );
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        write_origin( out, scene, "surface", i );
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        write_origin( out, scene, "collider", i );
    }
    fprintf( out,
             "\n    for ( int i = 0; i < COUNT( fabrics ); ++i )\n    {\n"
             "        wisp_fabric_release( fabrics[i] ); // surfaces keep theirs\n    }\n    return WISP_OK;\n}\n" );
}

static void write_main( FILE* out, const wisp_scene* scene )
{
    const int lengths = scene->dt_factor_count > 0 ? scene->dt_factor_count : 1;
    fprintf( out, "\nstatic const float LENGTHS[] = { // s, of steps in turn\n" );
    for ( int i = 0; i < lengths; ++i )
    {
        fprintf( out, "    %s,\n", TEXT( wisp_scene_step_length( scene, i ) ) );
    }
    fprintf( out,
             "};\n\nint main( void )\n{\n"
             "    wisp_error error = { 0 };\n"
             "    wisp_world* world = NULL;\n"
             "    wisp_world_def def = wisp_default_world_def();\n"
             "    def.modules = wisp_all_modules( &def.module_count );\n"
             "    def.substeps = %d, def.iterations = %d, def.workers = %d, def.longest_step = 1000;\n"
             "    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )\n    {\n"
             "        fprintf( stderr, \"%%s\\n\", error.message );\n        return 1;\n    }\n"
             "    wisp_status status = make( world );\n"
             "    for ( int step = 0; step < %d && status == WISP_OK; ++step )\n    {\n"
             "%s        status = status == WISP_OK ? wisp_world_step( world, LENGTHS[step %% COUNT( LENGTHS )] ) : "
             "status;\n    }\n"
             "    if ( status == WISP_OK )\n    {\n"
             "        printf( \"hash         %%016llx\\n\", (unsigned long long)wisp_world_hash( world ) );\n    }\n"
             "    else\n    {\n        fprintf( stderr, \"%%s\\n\", wisp_world_message( world ) );\n    }\n"
             "    wisp_world_destroy( world );\n    return status == WISP_OK ? 0 : 1;\n}\n",
             scene->substeps, scene->iterations, scene->workers, scene->steps,
             has_calls( scene ) ? "        status = BEFORE[step] != NULL ? BEFORE[step]( world ) : WISP_OK;\n" : "" );
}

wisp_status host_source_write( FILE* out, const wisp_scene* scene, wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    scene_world world;
    WISP_TRY( check( scene, error ) );
    WISP_TRY( scene_world_create( scene, &options, &world, error ) );
    fprintf( out, "// The world of %s.\n", scene->name );
    fputs( HEAD, out );
    wisp_status status = write_arrays( out, &world, error );
    if ( status == WISP_OK )
    {
        write_world( out, &world );
    }
    status = status == WISP_OK && has_calls( scene ) ? write_calls( out, &world, error ) : status;
    if ( status == WISP_OK )
    {
        write_main( out, scene );
    }
    scene_world_destroy( &world );
    return status;
}
