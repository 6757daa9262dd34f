// Definition of a layer, its components and passes, and views for the host.
#include "boundary_internal.h"

#include <string.h>

BOUNDARY_COMPONENTS( WISP_COMPONENT_COLUMNS )

enum
{
    BOUNDARY_MAX_POINTS = 1 << 27, // rows of four floats stay addressable by 32-bit numbers
};

// A length of 0 is by the mesh.
static const wisp_field BOUNDARY_FIELDS[] = {
    WISP_NUMBER_OR( wisp_boundary_def, spacing, 0, 1e-9, 1e9, "m" ),
    WISP_CHOICE( wisp_boundary_def, policy, WISP_SPACING_EVEN, WISP_SPACING_COUNT ),
    WISP_CHOICE( wisp_boundary_def, rounding, WISP_ROUND_DOWN, WISP_ROUND_COUNT ),
    WISP_NUMBER( wisp_boundary_def, hysteresis, 0, 0, 0.5, NULL ),
    WISP_WHOLE( wisp_boundary_def, max_points, 4000000, 1, BOUNDARY_MAX_POINTS ),
    WISP_NUMBER_OR( wisp_boundary_def, min_spacing, 0, 1e-9, 1e9, "m" ),
    WISP_NUMBER_OR( wisp_boundary_def, max_spacing, 0, 1e-9, 1e9, "m" ),
    WISP_NUMBER( wisp_boundary_def, curvature_gain, 0, 0, 1e6, "1/rad" ),
    WISP_NUMBER( wisp_boundary_def, strain_gain, 0, -1e6, 1e6, NULL ),
    WISP_NUMBER( wisp_boundary_def, eye_angle, 0, 0, 3.2, "rad" ),
    WISP_POINT( wisp_boundary_def, eye, -1e6, 1e6, "m", 0 ),
};
WISP_DEFINE( boundary_def, "boundary", BOUNDARY_FIELDS )

// ---- components and passes ----

static wisp_status declare_components( wisp_registry* r, boundary_state* s )
{
    BOUNDARY_COMPONENTS( WISP_COMPONENT_DECLARE )
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, boundary_settings, policy, 0, WISP_SPACING_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, boundary_settings, rounding, 0, WISP_ROUND_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, boundary_settings, limit, 1, BOUNDARY_MAX_POINTS ),
        WISP_COLUMN_RANGE( s->edges, BOUNDARY_POINTS, 0, BOUNDARY_MAX_POINTS ),
        WISP_COLUMN_RANGE( s->triangles, BOUNDARY_POINTS, 0, BOUNDARY_MAX_POINTS ),
        WISP_COLUMN_RANGE( s->triangles, BOUNDARY_AXIS, 0, 2 ),
    };
    return wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) );
}

// No pass writes positions: a layer is passive. The points read the spacing, so its pass comes before theirs; it exists only with
// a criterion.
static wisp_status declare_passes( wisp_registry* r, boundary_state* s )
{
    const wisp_component x = WISP_PARTICLE_POSITION;
    const wisp_pass passes[] = {
        { .name = "boundary.share",
          .stage = WISP_STAGE_INPUT,
          .required = { s->settings, s->read },
          .reads = { x, s->settings },
          .writes = { s->normals, s->edges, s->triangles },
          .run = boundary_share_points,
          .fabric = WISP_FABRIC_RINGS | WISP_FABRIC_EDGES },
        { .name = "boundary.normals",
          .stage = WISP_STAGE_DERIVE,
          .required = { s->settings },
          .reads = { x },
          .writes = { s->normals },
          .run = boundary_find_normals,
          .detail = WISP_PASS_WITHOUT_MOTION,
          .fabric = WISP_FABRIC_RINGS | WISP_FABRIC_EDGES },
        { .name = "boundary.spacing",
          .stage = WISP_STAGE_DERIVE,
          .required = { s->settings, s->local },
          .reads = { x, s->settings, s->normals },
          .writes = { s->edges, s->triangles },
          .run = boundary_find_spacing,
          .detail = WISP_PASS_WITHOUT_MOTION,
          .fabric = WISP_FABRIC_RINGS | WISP_FABRIC_EDGES },
        { .name = "boundary.points",
          .stage = WISP_STAGE_DERIVE,
          .required = { s->settings },
          .reads = { x, s->settings, s->normals, s->edges, s->triangles },
          .writes = { s->edges, s->triangles },
          .run = boundary_place_points,
          .detail = WISP_PASS_WITHOUT_MOTION,
          .fabric = WISP_FABRIC_RINGS | WISP_FABRIC_EDGES },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static size_t layer_bytes( const void* memory )
{
    const boundary_layer* layer = memory;
    return layer->bytes + wisp_samples_bytes( &layer->samples ) + layer->moved.size;
}

static wisp_status declare( wisp_registry* r )
{
    boundary_state* state = wisp_declare_state( r, sizeof( boundary_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->layers = wisp_declare_objects( r, boundary_layer_release, layer_bytes );
    WISP_TRY( declare_components( r, state ) );
    return declare_passes( r, state );
}

const wisp_module wisp_boundary_module = { .name = "boundary", .declare = declare };

// ---- checks ----

// Zero selects the default; all three are lengths.
static wisp_status check_spacing( wisp_world* world, const boundary_settings* s, const wisp_fabric* fabric )
{
    const struct
    {
        const char* name;
        float value;
    } lengths[] = {
        { "spacing", s->spacing },
        { "min_spacing", s->min_spacing },
        { "max_spacing", s->max_spacing },
    };
    if ( fabric->edge_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "boundary: got a surface without edges, expected at least one" );
    }
    for ( int i = 0; i < WISP_COUNT( lengths ); ++i )
    {
        if ( !( lengths[i].value >= 1e-9f && lengths[i].value <= 1e9f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "boundary: %s: got %g m, expected 1e-9 to 1e9",
                                    lengths[i].name, (double)lengths[i].value );
        }
    }
    if ( s->min_spacing > s->max_spacing )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "boundary: min_spacing: got %g m, expected at most max_spacing, which is %g m",
                                (double)s->min_spacing, (double)s->max_spacing );
    }
    return WISP_OK;
}

static boundary_settings fill_settings( const wisp_boundary_def* d, float mean_length )
{
    const float spacing = d->spacing == 0.0f ? 0.5f * mean_length : d->spacing;
    return ( boundary_settings ){
        .spacing = spacing,
        .policy = (int32_t)d->policy,
        .rounding = (int32_t)d->rounding,
        .limit = d->max_points,
        .hysteresis = d->hysteresis,
        .min_spacing = d->min_spacing == 0.0f ? 0.25f * spacing : d->min_spacing,
        .max_spacing = d->max_spacing == 0.0f ? 4.0f * spacing : d->max_spacing,
        .curvature_gain = d->curvature_gain,
        .strain_gain = d->strain_gain,
        .eye_angle = d->eye_angle,
        .eye = d->eye,
    };
}

// ---- components ----

// Points are always requested.
static wisp_status set_components( wisp_world* world, wisp_entity surface, const boundary_state* s, bool is_there,
                                   bool local )
{
    const wisp_component_use uses[] = {
        { s->settings, is_there },       { s->normals, is_there },
        { s->edges, is_there },          { s->triangles, is_there ? WISP_USED | WISP_REQUESTED : 0 },
        { s->local, is_there && local },
    };
    return wisp_world_set_components( world, surface, uses, WISP_COUNT( uses ) );
}

// Discard counts that belong to another definition.
static void forget_counts( wisp_world* world, wisp_entity surface, const boundary_state* state )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    for ( int k = 0; k < WISP_COUNT( edges_columns ); ++k )
    {
        memset( wisp_world_column( world, surface, state->edges, k ), 0,
                (size_t)fabric->edge_count * edges_columns[k].row_size );
    }
    for ( int k = 0; k < WISP_COUNT( triangles_columns ); ++k )
    {
        memset( wisp_world_column( world, surface, state->triangles, k ), 0,
                (size_t)fabric->triangle_count * triangles_columns[k].row_size );
    }
}

// ---- public functions ----

// Keep an existing layer, with its points until the next sampling.
static wisp_status provide_layer( wisp_world* world, wisp_entity surface, boundary_state* state,
                                  boundary_layer** out )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    *out = wisp_find_object( state->layers, surface );
    if ( *out == NULL && wisp_reserve_object( state->layers, surface ) )
    {
        *out = boundary_layer_create( allocator, wisp_world_fabric( world, surface ), surface );
    }
    return *out != NULL ? WISP_OK
                        : wisp_world_fail( world, WISP_NO_MEMORY,
                                           "boundary: out of memory for the elements of entity %u", surface.index );
}

wisp_status wisp_set_boundary( wisp_world* world, wisp_entity surface, const wisp_boundary_def* given )
{
    wisp_boundary_def values;
    const wisp_boundary_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &surface, &wisp_boundary_def_fields, &values, given ) );
    WISP_FIND_STATE( boundary_state, state, world, "boundary", &surface, WISP_IS_SURFACE );
    WISP_TRY( wisp_world_need_fabric( world, surface, WISP_FABRIC_EDGES | WISP_FABRIC_RINGS ) );
    const boundary_settings settings = fill_settings( def, wisp_world_rest_lengths( world, surface ).mean );
    const bool local = def->curvature_gain > 0.0f || def->strain_gain != 0.0f || def->eye_angle > 0.0f;
    boundary_layer* layer = NULL;
    wisp_status status = check_spacing( world, &settings, wisp_world_fabric( world, surface ) );
    status = status == WISP_OK ? provide_layer( world, surface, state, &layer ) : status;
    const bool had = wisp_find_object( state->layers, surface ) != NULL;
    status = status == WISP_OK ? set_components( world, surface, state, true, local ) : status;
    if ( status != WISP_OK )
    {
        boundary_layer_release( had ? NULL : layer, wisp_world_allocator( world ) );
        return status;
    }
    if ( had == false )
    {
        wisp_set_object( state->layers, surface, layer );
    }
    layer->made = false;
    wisp_world_share_samples( world, surface, &layer->samples );
    forget_counts( world, surface, state );
    memcpy( wisp_world_column( world, surface, state->settings, 0 ), &settings, sizeof( settings ) );
    return WISP_OK;
}

wisp_status wisp_unset_boundary( wisp_world* world, wisp_entity surface )
{
    WISP_FIND_STATE( boundary_state, state, world, "boundary", &surface, WISP_IS_SURFACE );
    WISP_TRY( set_components( world, surface, state, false, false ) );
    wisp_world_share_samples( world, surface, NULL );
    wisp_set_object( state->layers, surface, NULL );
    return WISP_OK;
}

// What the passes of the layer write: columns of edges, of triangles, and the normals.
// @return bytes of column number k, 0 behind the last
static size_t written_column( wisp_world* world, wisp_entity surface, const boundary_state* state, int k, void** out )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    const int edges = WISP_COUNT( edges_columns ), triangles = WISP_COUNT( triangles_columns );
    if ( k < edges )
    {
        *out = wisp_world_column( world, surface, state->edges, k );
        return (size_t)fabric->edge_count * edges_columns[k].row_size;
    }
    if ( k < edges + triangles )
    {
        *out = wisp_world_column( world, surface, state->triangles, k - edges );
        return (size_t)fabric->triangle_count * triangles_columns[k - edges].row_size;
    }
    *out = wisp_world_column( world, surface, state->normals, 0 );
    return k == edges + triangles ? 4 * sizeof( float ) * (size_t)fabric->slot_count : 0;
}

// Between all written columns and a block that holds them one after another. @return its bytes; null: copy nothing
static size_t copy_written( wisp_world* world, wisp_entity surface, const boundary_state* state, char* block,
                            bool is_back )
{
    size_t sum = 0, bytes;
    void* column;
    for ( int k = 0; ( bytes = written_column( world, surface, state, k, &column ) ) > 0; ++k )
    {
        if ( block != NULL )
        {
            memcpy( is_back ? column : block + sum, is_back ? block + sum : column, bytes );
        }
        sum += bytes;
    }
    return sum;
}

// Before a step the points of the layer are those of the present positions. Columns become again what they were, also those
// that a restore has brought, so that the step is the same with and without this.
static wisp_status make_early( wisp_world* world, wisp_entity surface, boundary_state* state, boundary_layer* layer )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = copy_written( world, surface, state, NULL, false );
    char* block = allocator->allocate( allocator->user, bytes, 64 );
    if ( block == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "boundary: out of memory for the points of entity %u",
                                surface.index );
    }
    copy_written( world, surface, state, block, false );
    const wisp_status status = wisp_world_run( world, surface, boundary_share_points, state );
    layer->made = false;
    layer->is_early = true;
    copy_written( world, surface, state, block, true );
    allocator->release( allocator->user, block, bytes );
    return status;
}

static wisp_status find_made( wisp_world* world, wisp_entity surface, boundary_layer** out )
{
    WISP_FIND_STATE( boundary_state, state, world, "boundary", &surface, WISP_IS_SURFACE );
    *out = wisp_find_object( state->layers, surface );
    return *out == NULL ? wisp_world_fail( world, WISP_CONFLICT, "boundary: entity %u has no layer", surface.index )
           : ( *out )->made ? WISP_OK
                            : make_early( world, surface, state, *out );
}

// Return the points as the host reads them; null without memory.
static const wisp_samples* show( wisp_world* world, boundary_layer* layer )
{
    const wisp_vec3 o = wisp_world_offset( world, layer->entity );
    const size_t count = (size_t)layer->samples.count;
    if ( o.x == 0.0f && o.y == 0.0f && o.z == 0.0f )
    {
        return &layer->samples;
    }
    if ( wisp_buffer_reserve( &layer->moved, wisp_world_allocator( world ), ( count + 8 ) * 4 * sizeof( float ) ) ==
         false )
    {
        return NULL;
    }
    float* to = layer->moved.data;
    memcpy( to, layer->samples.xyzw, count * 4 * sizeof( float ) );
    for ( size_t i = 0; i < count; ++i )
    {
        to[4 * i] -= o.x;
        to[4 * i + 1] -= o.y;
        to[4 * i + 2] -= o.z;
    }
    layer->shown = layer->samples;
    layer->shown.xyzw = to;
    return &layer->shown;
}

wisp_status wisp_read_boundary( wisp_world* world, wisp_entity surface, wisp_boundary_view* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    boundary_layer* layer;
    WISP_TRY( find_made( world, surface, &layer ) );
    const wisp_samples* samples = show( world, layer );
    if ( samples == NULL )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d boundary particles",
                                layer->samples.count );
    }
    *out = ( wisp_boundary_view ){
        .samples = samples,
        .edge_count = layer->edge_count,
        .edges = layer->edges,
        .slot_vertex = wisp_world_fabric( world, surface )->slot_vertex,
    };
    return WISP_OK;
}

static size_t bytes_of( const boundary_layer* layer )
{
    size_t bytes = layer->bytes;
    for ( int i = 0; i < WISP_COUNT( layer->samples.buffers ); ++i )
    {
        bytes += layer->samples.buffers[i].size;
    }
    return bytes;
}

wisp_status wisp_read_boundary_stats( wisp_world* world, wisp_entity surface, wisp_boundary_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    boundary_layer* layer;
    WISP_TRY( find_made( world, surface, &layer ) );
    const wisp_samples* s = &layer->samples;
    *out = ( wisp_boundary_stats ){
        .points = s->count,
        .edge_points = s->edge_count,
        .inner_points = s->count - s->edge_count,
        .elements = layer->edge_count + layer->triangle_count,
        .changed_elements = s->changed_elements,
        .skipped_elements = s->skipped_elements,
        .refused = s->refused,
        .requested = s->requested,
        .bytes = bytes_of( layer ),
    };
    return WISP_OK;
}
