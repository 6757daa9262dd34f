// Boundary particles: vertices, and points on edges and in triangles with barycentric weights. In: rest shapes, and the layers of
// surfaces that have boundary particles. Out: parents, weights and rest positions. Balls around them stand for the surface. That is
// several times cheaper than primitives, and lets pass what is finer than their spacing.
#include "boundary_samples.h"

#include "wisp/module/sampling.h"

#include <string.h>

// ---- particles of a surface ----

static bool reserve_samples( const contact_work* work, int count )
{
    contact_samples* s = work->contact_mesh->samples;
    const size_t n = (size_t)count;
    wisp_buffer* b = s->buffers;
    s->capacity = count;
    return contact_reserve( work, b++, n * sizeof( *s->parents ), (void**)&s->parents ) &&
           contact_reserve( work, b++, n * sizeof( *s->weights ), (void**)&s->weights ) &&
           contact_reserve( work, b++, n * sizeof( *s->rest ), (void**)&s->rest ) &&
           contact_reserve( work, b++, n * sizeof( *s->position ), (void**)&s->position ) &&
           contact_reserve( work, b++, n * sizeof( *s->deviation ), (void**)&s->deviation ) &&
           contact_reserve( work, b++, n * sizeof( *s->boxes ), (void**)&s->boxes );
}

// @return whether the particle was another one
static bool put_sample( contact_samples* s, int sample, const int32_t parents[3], const float weights[3] )
{
    const bool is_other = memcmp( s->parents[sample], parents, sizeof( *s->parents ) ) != 0 ||
                          memcmp( s->weights[sample], weights, sizeof( *s->weights ) ) != 0;
    memcpy( s->parents[sample], parents, sizeof( *s->parents ) );
    memcpy( s->weights[sample], weights, sizeof( *s->weights ) );
    return is_other;
}

// The vertices of a participant, and the points of a layer between them.
// @return whether any particle was another one
static bool add_samples( contact_contact_mesh* s, const contact_participant* participant, const wisp_samples* layer )
{
    static const float whole[3] = { 1.0f, 0.0f, 0.0f };
    bool is_other = false;
    for ( int i = 0; i < participant->point_count; ++i )
    {
        const int point = participant->first_point + i;
        is_other =
            put_sample( s->samples, s->samples->count++, ( const int32_t[3] ){ point, point, point }, whole ) ||
            is_other;
    }
    for ( int i = 0; layer != NULL && i < layer->count; ++i )
    {
        int32_t parents[3];
        for ( int k = 0; k < 3; ++k )
        {
            parents[k] = participant->first_point + layer->parents[i][k] / 4;
        }
        is_other = put_sample( s->samples, s->samples->count++, parents, layer->weights[i] ) || is_other;
    }
    return is_other;
}

static void place_at_rest( contact_contact_mesh* s, int first )
{
    for ( int i = first; i < s->samples->count; ++i )
    {
        contact_place_sample( s, s->rest, i, s->samples->rest[i] );
        s->samples->rest[i][3] = s->rest[(size_t)s->samples->parents[i][0] * 4 + 3];
    }
}

// ---- particles of contact itself, at rest ----

// Sample a surface at rest. The sampler keeps counts from call to call, so each call starts from zero, and the elements of a
// fabric, so each fabric starts without memory.
static wisp_status sample_surface( const contact_work* work, const contact_participant* participant )
{
    enum
    {
        NUMBERS_PER_EDGE = 2,
        NUMBERS_PER_TRIANGLE = 4,
        MAX_SAMPLES = 1 << 22,
    };
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_fabric* f = wisp_frame_fabric( work->frame, participant->entity );
    const size_t edges = (size_t)f->edge_count, triangles = (size_t)f->triangle_count;
    const size_t numbers = edges * NUMBERS_PER_EDGE + triangles * NUMBERS_PER_TRIANGLE;
    float* scratch = wisp_parallel_scratch( work->parallel, work->worker, ( numbers + 1 ) * sizeof( float ) );
    if ( scratch == NULL )
    {
        return WISP_NO_MEMORY;
    }
    memset( scratch, 0, numbers * sizeof( float ) );
    const float requested = work->settings->particle_spacing;
    int32_t* counts = (int32_t*)(void*)( scratch + edges + 2 * triangles );
    const wisp_samples_args args = {
        .position = s->rest + (size_t)participant->first_point * 4,
        .edges = f->edges,
        .edge_count = f->edge_count,
        .triangles = f->triangles,
        .triangle_count = f->triangle_count,
        .spacing = requested > 0.0f ? requested : s->min_thickness,
        .rounding = WISP_ROUND_UP,
        .limit = MAX_SAMPLES,
        .edge_length = scratch,
        .triangle_extent = scratch + edges,
        .edge_points = counts,
        .triangle_points = counts + edges,
        .triangle_axis = counts + edges + triangles,
    };
    wisp_samples_release( &s->samples->sampler, wisp_parallel_allocator( work->parallel ) );
    const wisp_status status =
        wisp_samples_update( &s->samples->sampler, work->parallel, wisp_frame_kernels( work->frame ), &args );
    return status == WISP_OK && s->samples->sampler.refused ? WISP_NO_MEMORY : status;
}

static const wisp_samples* shared_samples_of( const contact_work* work, const contact_participant* participant )
{
    return participant->is_strands || participant->is_left_out
               ? NULL
               : wisp_frame_samples( work->frame, participant->entity );
}

static bool has_own_samples( const contact_participant* participant )
{
    return participant->is_strands == false && participant->is_left_out == false && participant->has_layer == false;
}

// Those of a surface come from its own layer or from its rest shape; strands have their vertices alone.
static wisp_status count_own( const contact_work* work, int* total )
{
    wisp_status status = WISP_OK;
    *total = 0;
    for ( int g = 0; g < work->participant_count && status == WISP_OK; ++g )
    {
        contact_participant* participant = work->participants + g;
        const wisp_samples* layer = shared_samples_of( work, participant );
        participant->has_layer = layer != NULL;
        *total += participant->point_count + ( layer != NULL ? layer->count : 0 );
        if ( has_own_samples( participant ) )
        {
            status = sample_surface( work, participant );
            *total += status == WISP_OK ? work->contact_mesh->samples->sampler.count : 0;
        }
    }
    return status;
}

// Particles of layers stand behind all others, because their number changes.
static bool take_layers( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    const int before = s->samples->count;
    bool is_other = false;
    s->samples->count = s->samples->own_count;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        if ( participant->has_layer )
        {
            const wisp_samples* layer = wisp_frame_samples( work->frame, participant->entity );
            is_other = add_samples( s, participant, layer ) || is_other;
        }
    }
    return is_other || s->samples->count != before;
}

wisp_status contact_sample_participants( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    int total;
    // first count, so that the arrays do not grow while they are filled
    wisp_status status = count_own( work, &total );
    if ( status == WISP_OK && reserve_samples( work, total ) == false )
    {
        status = WISP_NO_MEMORY;
    }
    s->samples->count = 0;
    for ( int g = 0; g < work->participant_count && status == WISP_OK; ++g )
    {
        const contact_participant* participant = work->participants + g;
        const bool has_own = has_own_samples( participant );
        status = has_own ? sample_surface( work, participant ) : WISP_OK;
        if ( participant->has_layer == false && status == WISP_OK )
        {
            add_samples( s, participant, has_own ? &s->samples->sampler : NULL );
        }
    }
    s->samples->own_count = s->samples->count;
    if ( status == WISP_OK )
    {
        (void)take_layers( work );
        place_at_rest( s, 0 );
    }
    return status;
}

// ---- particles of layers, at the start of a step ----

wisp_status contact_follow_layers( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    int total = s->samples->own_count;
    bool fits = true;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        const wisp_samples* layer = shared_samples_of( work, participant );
        fits = fits && participant->has_layer == ( layer != NULL );
        total += layer != NULL ? participant->point_count + layer->count : 0;
    }
    if ( fits == false || total > s->samples->capacity )
    {
        s->is_listed = false;
        const wisp_status status = contact_sample_participants( work );
        return status == WISP_OK
                   ? WISP_OK
                   : wisp_fail( error, status, "out of memory for %d boundary particles in contact", total );
    }
    if ( take_layers( work ) )
    {
        s->is_listed = false;
        place_at_rest( s, s->samples->own_count );
    }
    return WISP_OK;
}

// ---- pairs ----

void contact_place_sample( const contact_contact_mesh* s, const float* xyzw, int sample, float out[3] )
{
    const int32_t* parents = s->samples->parents[sample];
    const float* weights = s->samples->weights[sample];
    for ( size_t k = 0; k < 3; ++k )
    {
        const float o = xyzw[(size_t)parents[0] * 4 + k];
        out[k] = o + weights[1] * ( xyzw[(size_t)parents[1] * 4 + k] - o ) +
                 weights[2] * ( xyzw[(size_t)parents[2] * 4 + k] - o );
    }
}

float contact_sample_distance( const contact_contact_mesh* s, const float* xyzw, int a, int b )
{
    float p[3], q[3];
    contact_place_sample( s, xyzw, a, p );
    contact_place_sample( s, xyzw, b, q );
    return contact_distance( p, q );
}

// Particles of one participant that are close at rest are no pair: their contact would stiffen the surface.
float contact_sample_gap_of( const contact_work* work, int a, int b )
{
    const contact_contact_mesh* s = work->contact_mesh;
    static const float REST_GAPS = 2.0f;
    const float *p = s->samples->rest[a], *q = s->samples->rest[b];
    const contact_participant *ga = work->participants + (int)p[3], *gb = work->participants + (int)q[3];
    const float gap = contact_gap_between( ga, gb );
    const float apart = REST_GAPS * gap + s->min_thickness;
    const bool is_pair = contact_may_meet( ga, gb ) && ( ga != gb || contact_distance( p, q ) > apart );
    return is_pair ? gap : 0.0f;
}
