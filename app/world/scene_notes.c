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
    const wisp_contact_def* contact;
    bool is_strands;
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
        return (
            participant ){ s->name, s->line, s->has_collision, s->has_contact, &s->collision, &s->contact, true };
    }
    const wisp_scene_surface* s = scene->surfaces + ( i - scene->strands_count );
    // pinned vertices are not moved
    return ( participant ){ s->name,        s->line,       s->has_collision && wisp_scene_is_driven( s ) == false,
                            s->has_contact, &s->collision, &s->contact,
                            false };
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

static void note_bodies( scene_world* world )
{
    const wisp_scene* scene = world->scene;
    for ( int b = 0; b < scene->surface_count + scene->collider_count; ++b )
    {
        const wisp_collider_def* body = body_of( scene, b );
        const bool is_surface = b < scene->surface_count;
        bool is_met = body == NULL || body->layers == 0; // the latter says so itself
        for ( int i = 0; i < participant_count( scene ) && is_met == false; ++i )
        {
            is_met = collides( scene, i, body, is_surface ? b : -1 - scene->strands_count );
        }
        if ( is_met == false )
        {
            const wisp_scene_collider* c = is_surface ? NULL : scene->colliders + ( b - scene->surface_count );
            say( world, is_surface ? scene->surfaces[b].line : c->line,
                 is_surface ? scene->surfaces[b].name : c->name,
                 "nothing collides with this collider: no 'collision' has one of its layers" );
        }
    }
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

static bool meets( const participant* a, const participant* b )
{
    return b->has_contact && b->contact->enabled && ( a->contact->layers & b->contact->mask ) != 0 &&
           ( b->contact->layers & a->contact->mask ) != 0 &&
           ( ( a->is_strands && b->is_strands ) == false ||
             ( a->contact->between_strands && b->contact->between_strands ) );
}

static bool finds_contact( const wisp_scene* scene, int i )
{
    const participant a = participant_of( scene, i );
    bool found = a.contact->self && ( a.is_strands == false || a.contact->between_strands );
    for ( int k = 0; k < participant_count( scene ) && found == false; ++k )
    {
        const participant b = participant_of( scene, k );
        found = k != i && meets( &a, &b );
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
        // a mask of nothing is one to count intersections with
        if ( p.has_contact && p.contact->enabled && p.contact->mask != 0 && finds_contact( scene, i ) == false )
        {
            say( world, p.line, p.name, "'contact' has no effect: it meets neither itself nor others" );
        }
    }
    if ( is_used == false )
    {
        scene_note( world, "the scene's 'contact' has no effect: no strands and no surface have one" );
    }
}

// ---- entries ----

static bool is_zero( wisp_vec3 v )
{
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}

static void note_surface( scene_world* world, const wisp_scene_surface* s )
{
    const wisp_cloth_def* c = &s->cloth;
    if ( s->has_cloth && is_zero( c->wind ) == false &&
         ( ( c->drag_coefficient == 0.0f && c->lift_coefficient == 0.0f ) || c->air_density == 0.0f ) )
    {
        say( world, s->line, s->name,
             "'wind' has no effect without drag_coefficient or lift_coefficient, and air_density" );
    }
    if ( s->has_collision && wisp_scene_is_driven( s ) )
    {
        say( world, s->line, s->name, "'collision' has no effect: the animation moves every vertex" );
    }
    if ( s->has_tearing && isinf( s->tearing.strength ) )
    {
        say( world, s->line, s->name, "'tearing' has no effect without a strength" );
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
    if ( s->has_dynamics && is_zero( s->dynamics.wind ) == false &&
         ( s->dynamics.drag_coefficient == 0.0f || s->dynamics.air_density == 0.0f ) )
    {
        say( world, s->line, s->name, "'wind' has no effect without drag_coefficient and air_density" );
    }
    if ( s->has_environment && s->has_frozen_hair == false )
    {
        say( world, s->line, s->name, "'environment' has no effect without frozen_hair" );
    }
    if ( s->has_frozen_hair && ( s->frozen_hair.freeze || s->frozen_hair.align || s->frozen_hair.clump ) == false )
    {
        say( world, s->line, s->name, "'frozen_hair' has no effect without freeze, align or clump" );
    }
    if ( s->has_grid && s->grid.enabled && s->grid.friction == 0.0f && s->grid.repulsion == 0.0f )
    {
        say( world, s->line, s->name, "'grid' has no effect without friction or repulsion" );
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
    }
    note_participants( world );
    note_bodies( world );
}
