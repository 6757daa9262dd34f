// What of a scene has no effect, or another one than it looks: a line each, told by the log when the world is built, and by `run`, `plan`
// and `info`. Warnings of modules are among them.
#include "world_from_scene_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void scene_note( scene_world* world, const char* line )
{
    char( *grown )[SCENE_NOTE_SIZE] =
        world->note_count < SCENE_MAX_NOTES
            ? realloc( world->notes, ( (size_t)world->note_count + 1 ) * sizeof( *grown ) )
            : NULL;
    if ( grown != NULL )
    {
        world->notes = grown;
        snprintf( grown[world->note_count++], sizeof( *grown ), "%s", line );
    }
    if ( world->is_quiet == false )
    {
        scene_tell( world, WISP_LOG_WARNING, line );
    }
}

// @param name of the entry, @param line of it in the scene
WISP_PRINTF( 4, 5 ) static void say( scene_world* world, int line, const char* name, const char* format, ... )
{
    char text[SCENE_NOTE_SIZE];
    const int head = snprintf( text, sizeof( text ), "%.80s:%d: '%.48s': ", world->scene->name, line, name );
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( text + head, sizeof( text ) - (size_t)head, format, arguments );
    va_end( arguments );
    scene_note( world, text );
}

// ---- participants ----

// An entry of strands or of surfaces, in the order of bodies.
typedef struct participant
{
    const char* name;
    int line;
    bool has_collision, has_contact;
    const wisp_collision_def* collision;
} participant;

static int participant_count( const wisp_scene* scene )
{
    return scene->strands_count + scene->surface_count;
}

static participant participant_of( const wisp_scene* scene, int i )
{
    if ( i < scene->strands_count )
    {
        const wisp_scene_strands* s = scene->strands + i;
        return ( participant ){ s->name, s->line, s->has_collision, s->has_contact, &s->collision };
    }
    const wisp_scene_surface* s = scene->surfaces + ( i - scene->strands_count );
    // pinned vertices are not moved
    return ( participant ){ s->name, s->line, s->has_collision && wisp_scene_is_driven( s ) == false, s->has_contact,
                            &s->collision };
}

void scene_note_warning( scene_world* world, const char* message )
{
    const wisp_scene* scene = world->scene;
    const int strands = scene->strands_count, bodies = participant_count( scene );
    unsigned index;
    int head = 0;
    bool is_named = false;
    for ( int i = 0; sscanf( message, "entity %u: %n", &index, &head ) == 1 && i < bodies + scene->collider_count;
          ++i )
    {
        const wisp_scene_collider* c = scene->colliders + ( i - bodies );
        const wisp_entity none = { 0, 0 },
                          e = i < strands  ? world->entities[i]
                              : i < bodies ? ( world->surfaces ? world->surfaces[i - strands].entity : none )
                                           : ( world->colliders ? world->colliders[i - bodies].entity : none );
        if ( e.generation != 0 && e.index == index )
        {
            say( world, i < bodies ? participant_of( scene, i ).line : c->line,
                 i < bodies ? participant_of( scene, i ).name : c->name, "%s", message + head );
            is_named = true;
        }
    }
    if ( is_named == false )
    {
        scene_note( world, message );
    }
}

// Whether participant i collides with a body. @param surface the body is this one, which does not meet itself; -1: none
static bool collides( const wisp_scene* scene, int i, const wisp_collider_def* body, int surface )
{
    const participant p = participant_of( scene, i );
    return p.has_collision && p.collision->enabled && ( p.collision->mask & body->layers ) != 0 &&
           i != scene->strands_count + surface;
}

// The body that a surface is, or null; behind the surfaces come the colliders.
static const wisp_collider_def* body_of( const wisp_scene* scene, int i )
{
    return i >= scene->surface_count         ? &scene->colliders[i - scene->surface_count].def
           : scene->surfaces[i].has_collider ? &scene->surfaces[i].collider
                                             : NULL;
}

static double mean_edge( const wisp_mesh* mesh )
{
    double sum = 0.0;
    for ( int k = 0; k < 3 * mesh->triangle_count; ++k )
    {
        const int next = k % 3 == 2 ? k - 2 : k + 1;
        sum += wisp_mesh_distance( mesh->points[mesh->triangles[k]], mesh->points[mesh->triangles[next]] );
    }
    return mesh->triangle_count > 0 ? sum / ( 3.0 * mesh->triangle_count ) : 0.0;
}

// An edge whose ends keep a thickness t from both sides of a right angle is at most L / 2^1.5 - t below its corner.
static void note_box_edges( scene_world* world, int surface )
{
    const wisp_scene* scene = world->scene;
    const wisp_scene_surface* s = scene->surfaces + surface;
    const double edge = mean_edge( &world->surfaces[surface].mesh );
    const double thickness = s->collision.thickness > 0.0f ? (double)s->collision.thickness : 0.25 * edge;
    const double depth = edge / sqrt( 8.0 ) - thickness;
    const bool is_cloth = s->has_cloth || s->has_implicit;
    for ( int c = 0; c < scene->collider_count && is_cloth && s->collision.features == WISP_COLLISION_VERTICES; ++c )
    {
        const wisp_scene_collider* box = scene->colliders + c;
        if ( box->def.kind == WISP_COLLIDER_BOX && depth > 0.0 &&
             collides( scene, scene->strands_count + surface, &box->def, -1 - scene->strands_count ) )
        {
            say( world, s->line, s->name,
                 "edges of %.3g mm pass up to %.2g mm through those of the box '%.40s': 'features: all' stops them",
                 1e3 * edge, 1e3 * depth, box->name );
            return;
        }
    }
}

// Cloth of a file whose vertices are split opens along all of these seams, unless the scene sews them.
static void note_split( scene_world* world, int surface )
{
    const wisp_scene* scene = world->scene;
    const wisp_scene_surface* s = scene->surfaces + surface;
    wisp_mesh mesh = world->surfaces[surface].mesh;
    mesh.vertex_count -= world->surfaces[surface].spare_count;
    bool is_open = ( s->mesh.file || s->mesh.arrays ) && s->instance_of < 0 && !wisp_scene_is_driven( s );
    for ( int i = 0; i < scene->seam_count; ++i )
    {
        is_open = is_open && scene->seams[i].surfaces[0] != surface && scene->seams[i].surfaces[1] != surface;
    }
    int count = 0;
    if ( is_open && wisp_mesh_count_near( &mesh, &count, NULL ) == WISP_OK && count > 0 )
    {
        say( world, s->line, s->name,
             "%d vertices are where others are, and nothing holds them together: 'repair: [weld]' joins them",
             count );
    }
}

static bool finds_body( const wisp_scene* scene, int i )
{
    bool found = false;
    for ( int b = 0; b < scene->surface_count + scene->collider_count && found == false; ++b )
    {
        const wisp_collider_def* body = body_of( scene, b );
        found = body != NULL && collides( scene, i, body, b < scene->surface_count ? b : -1 - scene->strands_count );
    }
    return found;
}

static void note_participants( scene_world* world )
{
    const wisp_scene* scene = world->scene;
    bool is_used = scene->has_contact == false;
    for ( int i = 0; i < participant_count( scene ); ++i )
    {
        const participant p = participant_of( scene, i );
        is_used = is_used || p.has_contact;
        if ( p.has_collision && p.collision->enabled && finds_body( scene, i ) == false )
        {
            say( world, p.line, p.name, "'collision' has no effect: no collider has a layer of its mask" );
        }
    }
    if ( is_used == false )
    {
        scene_note( world, "the scene's 'contact' has no effect: no strands and no surface have one" );
    }
}

// ---- entries ----

static void note_surface( scene_world* world, const wisp_scene_surface* s )
{
    if ( s->has_collision && wisp_scene_is_driven( s ) )
    {
        say( world, s->line, s->name, "'collision' has no effect: the animation moves every vertex" );
    }
}

static void note_segments( scene_world* world, const wisp_scene_strands* s, const wisp_groom* groom )
{
    const groom_shorts shorts = groom_find_shorts( groom );
    if ( shorts.count > 0 )
    {
        say( world, s->line, s->name, GROOM_SHORTS_FORMAT, GROOM_SHORTS( shorts ) );
    }
}

static void note_strands( scene_world* world, const wisp_scene_strands* s, const wisp_groom* groom )
{
    if ( s->has_environment && s->has_frozen_hair == false )
    {
        say( world, s->line, s->name, "'environment' has no effect without frozen_hair" );
    }
    note_segments( world, s, groom );
}

void scene_find_notes( scene_world* world )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        note_strands( world, scene->strands + i, world->grooms + i );
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        note_surface( world, scene->surfaces + i );
        note_box_edges( world, i );
        note_split( world, i );
    }
    note_participants( world );
    wisp_world_plan_passes( world->world ); // the plan tells the rest
}
