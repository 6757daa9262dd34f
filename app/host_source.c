// A scene as the C of a host: arrays of what its files and recipes make, and of each definition what is not as by default, by the tables
// that read scenes. Keys of a table are the members of its definition.
#include "host_source.h"

#include "scene_parts.h"
#include "world_from_scene_parts.h"

#include "wisp/fabric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- values ----

typedef struct number_text
{
    char text[40];
} number_text;

// Nine digits are every bit of a float.
static number_text number_of( float value )
{
    number_text n;
    snprintf( n.text, sizeof( n.text ), "%.9g", (double)value );
    const bool is_whole = strpbrk( n.text, ".en" ) == NULL; // inf and nan have an n
    snprintf( n.text, sizeof( n.text ), isinf( value ) ? "INFINITY" : is_whole ? "%.9g.0f" : "%.9gf", (double)value );
    return n;
}

#define TEXT( value ) number_of( value ).text

static void write_vector( FILE* out, wisp_vec3 v )
{
    fprintf( out, "( wisp_vec3 ){ %s, %s, %s }", TEXT( v.x ), TEXT( v.y ), TEXT( v.z ) );
}

// Write lines with a number in place of each #.
static void write_lines( FILE* out, const char* lines, int number )
{
    for ( const char* c = lines; *c != '\0'; ++c )
    {
        fprintf( out, *c == '#' ? "%d" : "%c", *c == '#' ? number : *c );
    }
}

static size_t size_of_field( const scene_field* field )
{
    switch ( field->type )
    {
        case SCENE_SWITCH:
        case SCENE_EITHER:
            return sizeof( bool );
        case SCENE_VECTOR:
            return sizeof( wisp_vec3 );
        case SCENE_SEED:
            return sizeof( uint64_t );
        case SCENE_NUMBER:
        case SCENE_WHOLE:
        case SCENE_CHOICE:
            return 4;
        default:
            return field->read == scene_read_layers ? sizeof( uint32_t ) : 0;
    }
}

static void write_value( FILE* out, const scene_field* field, const void* at )
{
    const wisp_vec3* v = at;
    switch ( field->type )
    {
        case SCENE_SWITCH:
        case SCENE_EITHER:
            fputs( *(const bool*)at ? "true" : "false", out );
            return;
        case SCENE_VECTOR:
            write_vector( out, *v );
            return;
        case SCENE_SEED:
            fprintf( out, "%lluu", (unsigned long long)*(const uint64_t*)at );
            return;
        case SCENE_NUMBER:
            fputs( TEXT( *(const float*)at ), out );
            return;
        default:
            fprintf( out, field->read == scene_read_layers ? "0x%xu" : "%d", *(const unsigned*)at );
            return;
    }
}

// ---- definitions ----

// A definition of a scene's entry: where it is, and what it is by default.
typedef struct definition
{
    size_t at, size; // in the entry
    const void *entry, *initial;
} definition;

// Write the values of a definition that are not those by default. Its members outside of the table are the caller's.
static void write_fields( FILE* out, const char* name, const scene_block* block, const definition* d )
{
    for ( int i = 0; i < block->field_count; ++i )
    {
        const scene_field* f = &block->fields[i];
        const size_t size = size_of_field( f );
        const char *value = (const char*)d->entry + f->at, *initial = (const char*)d->initial + f->at;
        const bool is_own = f->at >= d->at && f->at + size <= d->at + d->size && strcmp( f->key, "shape" ) != 0 &&
                            strcmp( f->key, "position" ) != 0;
        if ( size > 0 && is_own && memcmp( value, initial, size ) != 0 )
        {
            fprintf( out, "    %s.%s = ", name, f->key );
            write_value( out, f, value );
            fputs( ";\n", out );
        }
    }
}

// @param name of the variable
static void begin_definition( FILE* out, const char* type, const char* name )
{
    fprintf( out, "    wisp_%s_def %s = wisp_default_%s_def();\n", type, name, type );
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

#define OF_SURFACE( key, type, member )                                                                              \
    {                                                                                                                \
        key, type, offsetof( wisp_scene_surface, member ), sizeof( ( (wisp_scene_surface*)0 )->member )              \
    }
#define OF_STRANDS( key, type, member )                                                                              \
    {                                                                                                                \
        key, type, offsetof( wisp_scene_strands, member ), sizeof( ( (wisp_scene_strands*)0 )->member )              \
    }
static const effect SURFACE_EFFECTS[] = {
    OF_SURFACE( "membrane", "membrane", membrane ),    OF_SURFACE( "cloth", "cloth", cloth ),
    OF_SURFACE( "balloon", "balloon", balloon ),       OF_SURFACE( "implicit", "implicit_cloth", implicit ),
    OF_SURFACE( "collision", "collision", collision ), OF_SURFACE( "contact", "contact", contact ),
    OF_SURFACE( "collider", NULL, collider ),          OF_SURFACE( "start", NULL, start ),
};
static const effect STRANDS_EFFECTS[] = {
    OF_STRANDS( "appearance", "strand_appearance", appearance ),
    OF_STRANDS( "dynamics", "strand_dynamics", dynamics ),
    OF_STRANDS( "grid", "strand_grid", grid ),
    OF_STRANDS( "collision", "collision", collision ),
    OF_STRANDS( "contact", "contact", contact ),
    OF_STRANDS( "scatter", NULL, scatter ),
};

static void write_effects( FILE* out, const char* of, int number, const effect* effects, int count,
                           const scene_block* block, const void* entry, const void* initial )
{
    for ( int i = 0; i < count; ++i )
    {
        const effect* e = effects + i;
        const scene_field* field = find_field( block, e->key );
        char name[40];
        if ( e->type != NULL && *( (const bool*)entry + field->at ) )
        {
            snprintf( name, sizeof( name ), "%s_%s%d", e->key, of, number );
            begin_definition( out, e->type, name );
            write_fields( out, name, field->block, &( definition ){ e->at, e->size, entry, initial } );
            fprintf( out, "    TRY( wisp_set_%s( world, %s%d, &%s ) );\n", e->type, of, number, name );
        }
    }
}

// ---- what it cannot express ----

// A block that is none of the effects, as a key. @return null: there is none
static const char* find_other( const scene_block* block, const void* entry, const effect* effects, int count )
{
    const char* found = NULL;
    for ( int i = 0; i < block->field_count && found == NULL; ++i )
    {
        const scene_field* f = &block->fields[i];
        bool is_known = f->block == NULL || f->at == 0 || *( (const bool*)entry + f->at ) == false;
        for ( int k = 0; k < count && is_known == false; ++k )
        {
            is_known = strcmp( effects[k].key, f->key ) == 0;
        }
        found = is_known ? NULL : f->key;
    }
    return found;
}

static const char* other_of_surface( const wisp_scene_surface* s )
{
    bool moves_pins = false;
    for ( int g = 0; g <= s->pin_group_count; ++g )
    {
        const wisp_scene_pins* pins = scene_pins_entry( s, g );
        moves_pins = moves_pins || pins->path.count > 0 || pins->attached_to >= 0;
    }
    const bool has_outlet = s->balloon.outlet_count > 0 || s->has_outlet_nearest || s->gas_ratio_keyframe_count > 0;
    return moves_pins              ? "pins that move"
           : s->map_count > 0      ? "maps"
           : s->mass_ratio != 1.0f ? "mass_ratio"
           : s->has_quad_links     ? "implicit.links"
           : has_outlet            ? "balloon.outlet"
           : s->max_speed < INFINITY
               ? "max_speed"
               : find_other( &SCENE_SURFACE_BLOCK, s, SURFACE_EFFECTS, WISP_COUNT( SURFACE_EFFECTS ) );
}

static const char* other_of_strands( const wisp_scene_strands* s )
{
    return s->mass_ratio != 1.0f       ? "mass_ratio"
           : s->mass_count > 0         ? "dynamics.vertex_masses"
           : s->dynamics.pin_count > 0 ? "dynamics.pins"
           : s->on_surface >= 0        ? "on_surface"
           : s->max_speed < INFINITY
               ? "max_speed"
               : find_other( &SCENE_STRANDS_BLOCK, s, STRANDS_EFFECTS, WISP_COUNT( STRANDS_EFFECTS ) );
}

static wisp_status refuse( const wisp_scene* scene, int line, const char* what, wisp_error* error )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s:%d: got '%s', which --host does not print", scene->name, line,
                      what );
}

static wisp_status check( const wisp_scene* scene, wisp_error* error )
{
    const char* of_scene = scene->dt_factor_count > 0 ? "dt_factors"
                           : scene->event_count > 0   ? "events"
                           : scene->command_count > 0 ? "hair_events"
                           : scene->seam_count > 0    ? "seams"
                                                      : NULL;
    wisp_status status = of_scene != NULL ? refuse( scene, 1, of_scene, error ) : WISP_OK;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        const char* other = other_of_strands( &scene->strands[i] );
        status = other != NULL ? refuse( scene, scene->strands[i].line, other, error ) : WISP_OK;
    }
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        const char* other = other_of_surface( &scene->surfaces[i] );
        status = other != NULL ? refuse( scene, scene->surfaces[i].line, other, error ) : WISP_OK;
    }
    for ( int i = 0; i < scene->collider_count && status == WISP_OK; ++i )
    {
        const bool moves = scene->colliders[i].path.count > 0;
        status = moves ? refuse( scene, scene->colliders[i].line, "keyframes", error ) : WISP_OK;
    }
    return status;
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

static void write_strands( FILE* out, const scene_world* world, int i )
{
    static const char* const COMPONENTS[] = { "STRAND_POINTS", "POINT_WIDTH", "POINT_COLOUR",
                                              "POINT_STRAIN",  "POINT_SPEED", "MOTION_STATS" };
    const wisp_scene_strands* s = &world->scene->strands[i];
    const wisp_scene_strands initial = scene_default_strands( wisp_default_surface_def().gravity );
    const bool requested[] = { s->request_points, s->request_width, s->request_colour,
                               s->request_strain, s->request_speed, s->request_motion_stats };
    fprintf( out, "\n    // %s\n", s->name );
    write_lines( out,
                 "    wisp_strands_def strands_def# = wisp_default_strands_def();\n"
                 "    strands_def#.points = strand_points#;\n"
                 "    strands_def#.offsets = strand_offsets#;\n"
                 "    strands_def#.strand_count = COUNT( strand_offsets# ) - 1;\n",
                 i );
    fprintf( out, "    strands_def%d.dimension = %d;\n", i, world->grooms[i].dimension );
    write_lines( out,
                 "    wisp_entity strands#;\n"
                 "    TRY( wisp_add_strands( world, &strands_def#, &strands# ) );\n",
                 i );
    write_effects( out, "strands", i, STRANDS_EFFECTS, 1, &SCENE_STRANDS_BLOCK, s, &initial );
    write_requests( out, "strands", i, requested, COMPONENTS, WISP_COUNT( COMPONENTS ) );
}

// After surfaces and colliders, as in a scene.
static void write_dynamics( FILE* out, const wisp_scene* scene, int i )
{
    const wisp_scene_strands* s = &scene->strands[i];
    const wisp_scene_strands initial = scene_default_strands( wisp_default_surface_def().gravity );
    write_effects( out, "strands", i, STRANDS_EFFECTS + 1, WISP_COUNT( STRANDS_EFFECTS ) - 1, &SCENE_STRANDS_BLOCK, s,
                   &initial );
    if ( s->substeps > 0 )
    {
        fprintf( out, "    TRY( wisp_set_substeps( world, strands%d, %d ) );\n", i, s->substeps );
    }
    if ( s->request_contacts )
    {
        write_lines( out, "    TRY( wisp_request_collision_stats( world, strands#, true ) );\n", i );
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
        { "solve_order", (int)def.solve_order, (int)initial.solve_order },
        { "tile_size", def.tile_size, initial.tile_size },
    };
    write_lines( out,
                 "    wisp_fabric_def fabric_def# = wisp_default_fabric_def();\n"
                 "    fabric_def#.points = rest#;\n"
                 "    fabric_def#.vertex_count = COUNT( rest# );\n"
                 "    fabric_def#.triangles = triangles#;\n"
                 "    fabric_def#.triangle_count = COUNT( triangles# ) / 3;\n",
                 i );
    if ( def.attachment_count > 0 )
    {
        write_lines( out,
                     "    fabric_def#.attachments = pins#;\n"
                     "    fabric_def#.attachment_count = COUNT( pins# );\n",
                     i );
    }
    for ( int k = 0; k < WISP_COUNT( members ); ++k )
    {
        if ( members[k].value != members[k].initial )
        {
            fprintf( out, "    fabric_def%d.%s = %d;\n", i, members[k].name, members[k].value );
        }
    }
    write_lines( out, "    TRY( wisp_fabric_cook( &fabric_def#, NULL, &fabrics[#], NULL ) );\n", i );
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
    write_lines( out, "    wisp_surface_def surface_def# = wisp_default_surface_def();\n", i );
    fprintf( out, "    surface_def%d.fabric = fabrics[%d];\n", i, s->instance_of < 0 ? i : s->instance_of );
    write_lines( out, "    surface_def#.points = points#;\n", i );
    if ( world->surfaces[i].pin_count > 0 )
    {
        write_lines( out,
                     "    surface_def#.pins = pins#;\n"
                     "    surface_def#.pin_count = COUNT( pins# );\n",
                     i );
    }
    for ( int k = 0; k < WISP_COUNT( MEMBERS ); ++k )
    {
        const scene_field* f = find_field( &SCENE_SURFACE_BLOCK, MEMBERS[k] );
        if ( memcmp( (const char*)s + f->at, (const char*)&initial + f->at, size_of_field( f ) ) != 0 )
        {
            fprintf( out, "    surface_def%d.%s = ", i, MEMBERS[k] );
            write_value( out, f, (const char*)s + f->at );
            fputs( ";\n", out );
        }
    }
    write_lines( out,
                 "    wisp_entity surface#;\n"
                 "    TRY( wisp_add_surface( world, &surface_def#, &surface# ) );\n",
                 i );
    if ( s->damping > 0.0f )
    {
        fprintf( out, "    TRY( wisp_set_damping( world, surface%d, %s ) );\n", i, TEXT( s->damping ) );
    }
    if ( s->strain_limit[0] > 0.0f || s->strain_limit[1] < INFINITY )
    {
        fprintf( out, "    TRY( wisp_set_strain_limit( world, surface%d, %s, %s ) );\n", i,
                 TEXT( s->strain_limit[0] ), TEXT( s->strain_limit[1] ) );
    }
    if ( s->substeps > 0 )
    {
        fprintf( out, "    TRY( wisp_set_substeps( world, surface%d, %d ) );\n", i, s->substeps );
    }
    if ( v.x != 0.0f || v.y != 0.0f || v.z != 0.0f || w.x != 0.0f || w.y != 0.0f || w.z != 0.0f )
    {
        fprintf( out, "    TRY( wisp_set_velocity( world, surface%d, ", i );
        write_vector( out, v );
        fputs( ", ", out );
        write_vector( out, w );
        fputs( " ) );\n", out );
    }
    write_effects( out, "surface", i, SURFACE_EFFECTS, WISP_COUNT( SURFACE_EFFECTS ), &SCENE_SURFACE_BLOCK, s,
                   &initial );
    write_requests( out, "surface", i, requested, COMPONENTS, WISP_COUNT( COMPONENTS ) );
    if ( s->request_stats )
    {
        fprintf( out, "    TRY( wisp_request_%s_stats( world, surface%d, true ) );\n",
                 s->has_balloon ? "balloon" : "implicit_cloth", i );
    }
    if ( s->request_contacts )
    {
        write_lines( out, "    TRY( wisp_request_collision_stats( world, surface#, true ) );\n", i );
    }
}

// What tables of colliders leave to readers of their own.
static void write_body( FILE* out, const char* name, const wisp_collider_def* d )
{
    const wisp_quat q = d->pose.rotation;
    fprintf( out, "    %s.kind = %d;\n    %s.static_friction = %s, %s.kinetic_friction = %s;\n", name, (int)d->kind,
             name, TEXT( d->static_friction ), name, TEXT( d->kinetic_friction ) );
    fprintf( out, "    %s.pose = ( wisp_transform ){ { %s, %s, %s, %s }, ", name, TEXT( q.x ), TEXT( q.y ),
             TEXT( q.z ), TEXT( q.w ) );
    const wisp_vec3 p = d->pose.translation;
    fprintf( out, "{ %s, %s, %s } };\n", TEXT( p.x ), TEXT( p.y ), TEXT( p.z ) );
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
    begin_definition( out, "collider", name );
    write_fields( out, name, &SCENE_SURFACE_COLLIDER_BLOCK,
                  &( definition ){ offsetof( wisp_scene_surface, collider ), sizeof( s->collider ), s, &initial } );
    write_body( out, name, &def );
    write_lines( out,
                 "    surface_collider#.surface = surface#;\n"
                 "    wisp_entity of_surface#;\n"
                 "    TRY( wisp_add_collider( world, &surface_collider#, &of_surface# ) );\n",
                 i );
}

static void write_collider( FILE* out, const wisp_scene* scene, int i )
{
    const wisp_scene_collider* c = &scene->colliders[i];
    const wisp_scene_collider initial = scene_default_collider();
    char name[40];
    snprintf( name, sizeof( name ), "collider_def%d", i );
    fprintf( out, "\n    // %s\n", c->name );
    begin_definition( out, "collider", name );
    write_fields( out, name, &SCENE_COLLIDER_BLOCKS[c->def.kind],
                  &( definition ){ offsetof( wisp_scene_collider, def ), sizeof( c->def ), c, &initial } );
    write_body( out, name, &c->def );
    if ( c->def.kind == WISP_COLLIDER_MESH || c->def.kind == WISP_COLLIDER_CONVEX )
    {
        write_lines( out,
                     "    collider_def#.points = body_points#;\n"
                     "    collider_def#.point_count = COUNT( body_points# );\n"
                     "    collider_def#.triangles = body_triangles#;\n"
                     "    collider_def#.triangle_count = COUNT( body_triangles# ) / 3;\n",
                     i );
    }
    if ( c->def.kind == WISP_COLLIDER_HEIGHT_FIELD )
    {
        write_lines( out, "    collider_def#.heights = heights#;\n", i );
        fprintf( out, "    collider_def%d.height_count_x = %d, collider_def%d.height_count_z = %d;\n", i,
                 c->def.height_count_x, i, c->def.height_count_z );
    }
    write_lines( out,
                 "    wisp_entity collider#;\n"
                 "    TRY( wisp_add_collider( world, &collider_def#, &collider# ) );\n",
                 i );
    if ( c->request_reaction )
    {
        write_lines( out, "    TRY( wisp_request_reaction( world, collider#, true ) );\n", i );
    }
}

// ---- the program ----

static const char HEAD[] = "\n"
                           "#include <wisp/balloon.h>\n"
                           "#include <wisp/create.h>\n"
                           "#include <wisp/fabric.h>\n"
                           "#include <wisp/implicit_cloth.h>\n"
                           "#include <wisp/membrane.h>\n"
                           "#include <wisp/strand_appearance.h>\n"
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

static void write_world( FILE* out, const scene_world* world )
{
    const wisp_scene *scene = world->scene, initial = scene_defaults();
    fprintf( out, "\nstatic wisp_status make( wisp_world* world )\n{\n    wisp_fabric* fabrics[%d] = { NULL };\n",
             scene->surface_count + 1 );
    if ( scene->has_contact )
    {
        fputs( "    wisp_contact_settings settings = wisp_default_contact_settings();\n", out );
        write_fields( out, "settings", &SCENE_WORLD_CONTACT_BLOCK,
                      &( definition ){ offsetof( wisp_scene, contact ), sizeof( scene->contact ), scene, &initial } );
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
        if ( scene->surfaces[i].has_collider )
        {
            write_surface_collider( out, scene, i );
        }
    }
    for ( int i = 0; i < scene->collider_count; ++i )
    {
        write_collider( out, scene, i );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        write_dynamics( out, scene, i );
        write_origin( out, scene, "strands", i );
    }
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
    fprintf( out,
             "\nint main( void )\n{\n"
             "    wisp_error error = { 0 };\n"
             "    wisp_world* world = NULL;\n"
             "    wisp_world_def def = wisp_default_world_def();\n"
             "    def.modules = wisp_all_modules( &def.module_count );\n"
             "    def.substeps = %d, def.iterations = %d, def.workers = %d, def.longest_step = 1000;\n"
             "    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )\n    {\n"
             "        fprintf( stderr, \"%%s\\n\", error.message );\n        return 1;\n    }\n"
             "    wisp_status status = make( world );\n"
             "    for ( int step = 0; step < %d && status == WISP_OK; ++step )\n    {\n"
             "        status = wisp_world_step( world, %s );\n    }\n"
             "    if ( status == WISP_OK )\n    {\n"
             "        printf( \"hash         %%016llx\\n\", (unsigned long long)wisp_world_hash( world ) );\n    }\n"
             "    else\n    {\n        fprintf( stderr, \"%%s\\n\", wisp_world_message( world ) );\n    }\n"
             "    wisp_world_destroy( world );\n    return status == WISP_OK ? 0 : 1;\n}\n",
             scene->substeps, scene->iterations, scene->workers, scene->steps, TEXT( scene->dt ) );
}

wisp_status host_source_write( FILE* out, const wisp_scene* scene, wisp_error* error )
{
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    scene_world world;
    wisp_status status = check( scene, error );
    status = status == WISP_OK ? scene_world_create( scene, &options, &world, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    fprintf( out, "// The world of %s.\n", scene->name );
    fputs( HEAD, out );
    status = write_arrays( out, &world, error );
    if ( status == WISP_OK )
    {
        write_world( out, &world );
        write_main( out, scene );
    }
    scene_world_destroy( &world );
    return status;
}
