// Strands: their definition, their rows, the pass that hands their points out; and instances of strands and surfaces.
#include "world.h"

#include "wisp/module/vec.h"
#include "wisp/module/components.h"

#include <math.h>
#include <string.h>

enum
{
    WORLD_MAX_VERTICES = 1 << 28, // quads of floats stay addressable by 32-bit numbers
};

static const wisp_field STRANDS_FIELDS[] = {
    WISP_WHOLE( wisp_strands_def, strand_count, 0, 0, WORLD_MAX_VERTICES ),
    WISP_WHOLE( wisp_strands_def, dimension, 3, 2, 3 ),
};
WISP_DEFINE( strands_def, "strands", STRANDS_FIELDS )

// ---- the pass that hands points out ----

static void unpack_points( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_strand_unpack_args job = {
        .group_row = t->group_row,
        .lane_strand = t->lane_strand,
        .lane_count = t->lane_count,
        .offsets = t->offsets,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .points = wisp_frame_column( frame, span->entity, WISP_STRAND_POINTS, 0 ),
    };
    wisp_frame_kernels( frame )->strand_unpack( &job, span->begin, span->end );
    const wisp_vec3 o = wisp_frame_offset( frame, span->entity );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES && wisp_v3_dot( o, o ) > 0.0f; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            wisp_vec3* p = (wisp_vec3*)(void*)job.points + t->offsets[t->lane_strand[i]] + v;
            *p = wisp_v3_sub( *p, o );
        }
    }
}

wisp_status world_declare_strands( wisp_registry* registry )
{
    return wisp_declare_pass( registry, &( wisp_pass ){
                                            WISP_PASS( "strands.points", OBSERVE, STRAND_GROUP, unpack_points ),
                                            .required = { WISP_STRAND_POSITION },
                                            .reads = { WISP_STRAND_POSITION },
                                            .writes = { WISP_STRAND_POINTS },
                                            .detail = WISP_PASS_WITHOUT_MOTION,
                                            .on_change = WISP_STRAND_POSITION,
                                        } );
}

// ---- strands ----

static wisp_status check_strand_points( wisp_world* world, const wisp_strands_def* def )
{
    for ( int s = 0; s < def->strand_count; ++s )
    {
        for ( int v = def->offsets[s]; v < def->offsets[s + 1]; ++v )
        {
            const wisp_vec3 p = def->points[v];
            if ( !( fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f ) )
            {
                return wisp_world_fail(
                    world, WISP_BAD_INPUT,
                    "strand %d, vertex %d: got (%g, %g, %g), expected finite coordinates within 1e6 m of the origin",
                    s, v - def->offsets[s], (double)p.x, (double)p.y, (double)p.z );
            }
            if ( def->dimension == 2 && p.z != 0.0f )
            {
                return wisp_world_fail( world, WISP_BAD_INPUT,
                                        "strand %d, vertex %d: got z = %g, expected 0 in dimension 2", s,
                                        v - def->offsets[s], (double)p.z );
            }
        }
    }
    return WISP_OK;
}

static wisp_status check_strands( wisp_world* world, const wisp_strands_def* def )
{
    if ( def->offsets == NULL )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strand_count: got %d, but offsets is null",
                                def->strand_count );
    }
    if ( def->offsets[0] != 0 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "offsets: got %d as the first, expected 0", def->offsets[0] );
    }
    for ( int s = 0; s < def->strand_count; ++s )
    {
        if ( def->offsets[s + 1] < def->offsets[s] || def->offsets[s + 1] > WORLD_MAX_VERTICES )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "strand %d: got vertices %d to %d, expected offsets that ascend up to %d", s,
                                    def->offsets[s], def->offsets[s + 1], WORLD_MAX_VERTICES );
        }
    }
    if ( def->offsets[def->strand_count] > 0 && def->points == NULL )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "points: got null, expected %d points",
                                def->offsets[def->strand_count] );
    }
    return check_strand_points( world, def );
}

// Rows, components and topology of a new entity; on failure nothing stays.
static wisp_status add_strands_entity( wisp_world* world, cook_strands* strands, wisp_entity* out )
{
    const wisp_strand_topology* t = &strands->topology;
    int rows[WISP_TABLE_COUNT] = {
        [WISP_TABLE_ENTITY] = 1,
        [WISP_TABLE_STRAND_GROUP] = t->group_count,
        [WISP_TABLE_STRAND_ROW] = t->row_count,
        [WISP_TABLE_POINT] = t->vertex_count,
    };
    wisp_entity entity;
    if ( store_add( &world->store, rows, &entity ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d strands", t->strand_count );
    }
    if ( store_attach( &world->store, entity, WISP_STRAND_REST ) == false ||
         store_attach( &world->store, entity, WISP_STRAND_POSITION ) == false )
    {
        store_remove( &world->store, entity );
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the vertices of %d strands",
                                t->strand_count );
    }
    store_find( &world->store, entity )->strands = t;
    *out = entity;
    return WISP_OK;
}

static size_t row_bytes( const wisp_strand_topology* t )
{
    return (size_t)t->row_count * 3 * WISP_LANES * sizeof( float );
}

wisp_status wisp_add_strands( wisp_world* world, const wisp_strands_def* given, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    wisp_strands_def values;
    const wisp_strands_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_strands_def_fields, &values, given ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    WISP_TRY( check_strands( world, def ) );
    cook_strands* strands = cook_strands_create( &world->allocator, def->offsets, def->strand_count, def->dimension );
    if ( strands == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory to cook %d strands", def->strand_count );
    }
    wisp_status status = add_strands_entity( world, strands, out );
    if ( status != WISP_OK )
    {
        cook_strands_release( strands );
        return status;
    }
    const store_entity* e = store_find( &world->store, *out );
    float* rest = store_column( &world->store, e, WISP_STRAND_REST, 0 );
    cook_strands_pack( &strands->topology, def->points, rest );
    memcpy( store_column( &world->store, e, WISP_STRAND_POSITION, 0 ), rest, row_bytes( &strands->topology ) );
    return WISP_OK;
}

// ---- instances ----

static wisp_status add_strands_instance( wisp_world* world, wisp_entity source, cook_strands* strands,
                                         wisp_entity* out )
{
    WISP_TRY( add_strands_entity( world, strands, out ) );
    cook_strands_retain( strands );
    const store_entity* from = store_find( &world->store, source ); // slots may have moved
    const store_entity* e = store_find( &world->store, *out );
    const float* rest = store_column( &world->store, from, WISP_STRAND_REST, 0 );
    memcpy( store_column( &world->store, e, WISP_STRAND_REST, 0 ), rest, row_bytes( &strands->topology ) );
    memcpy( store_column( &world->store, e, WISP_STRAND_POSITION, 0 ), rest, row_bytes( &strands->topology ) );
    return WISP_OK;
}

wisp_status wisp_add_instance( wisp_world* world, wisp_entity source, const wisp_transform* pose, wisp_entity* out )
{
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    WISP_TRY( wisp_world_check_entity( world, source ) );
    const store_entity* from = store_find( &world->store, source );
    if ( from->fabric == NULL && from->strands == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u: has no strands and no surface to share",
                                source.index );
    }
    WISP_TRY( pose != NULL ? world_check_pose( world, from, *pose ) : WISP_OK );
    WISP_TRY( from->fabric != NULL
                  ? world_add_surface_instance( world, source, out )
                  : add_strands_instance( world, source, (cook_strands*)(void*)from->strands, out ) );
    if ( pose != NULL )
    {
        world_place( world, *out, *pose );
    }
    return WISP_OK;
}
