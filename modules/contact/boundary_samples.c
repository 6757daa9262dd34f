// Boundary particles: vertices, and points on edges and in triangles with barycentric weights. In: rest shapes. Out:
// parents, weights and rest positions. Balls around them stand for the surface. That is several times cheaper than
// primitives, and lets pass what is finer than their spacing.
#include "boundary_samples.h"

#include "wisp/module/sampling.h"

#include <string.h>

// ---- sampling, at rest ----

static bool reserve_samples( const contact_work* work, int count )
{
    contact_samples* s = work->contact_mesh->samples;
    const size_t n = (size_t)count;
    wisp_buffer* b = s->buffers;
    return contact_reserve( work, b++, n * sizeof( *s->parents ), (void**)&s->parents ) &&
           contact_reserve( work, b++, n * sizeof( *s->weights ), (void**)&s->weights ) &&
           contact_reserve( work, b++, n * sizeof( *s->rest ), (void**)&s->rest ) &&
           contact_reserve( work, b++, n * sizeof( *s->position ), (void**)&s->position ) &&
           contact_reserve( work, b++, n * sizeof( *s->deviation ), (void**)&s->deviation ) &&
           contact_reserve( work, b++, n * sizeof( *s->boxes ), (void**)&s->boxes );
}

static void add_vertices( contact_contact_mesh* s, const contact_participant* participant )
{
    for ( int i = 0; i < participant->point_count; ++i )
    {
        const int point = participant->first_point + i, sample = s->samples->count++;
        for ( int k = 0; k < 3; ++k )
        {
            s->samples->parents[sample][k] = point;
            s->samples->weights[sample][k] = k == 0 ? 1.0f : 0.0f;
        }
    }
}

static void add_samples( contact_contact_mesh* s, const wisp_samples* layer, int first_point )
{
    for ( int i = 0; layer != NULL && i < layer->count; ++i )
    {
        const int sample = s->samples->count++;
        for ( int k = 0; k < 3; ++k )
        {
            s->samples->parents[sample][k] = first_point + layer->parents[i][k] / 4;
            s->samples->weights[sample][k] = layer->weights[i][k];
        }
    }
}

static void place_at_rest( contact_contact_mesh* s )
{
    for ( int i = 0; i < s->samples->count; ++i )
    {
        contact_place_sample( s, s->rest, i, s->samples->rest[i] );
        s->samples->rest[i][3] = s->rest[(size_t)s->samples->parents[i][0] * 4 + 3];
    }
}

// Sample a surface at rest. The sampler keeps counts from call to call, so each call starts from zero.
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
    const wisp_status status =
        wisp_samples_update( &s->samples->sampler, work->parallel, wisp_frame_kernels( work->frame ), &args );
    return status == WISP_OK && s->samples->sampler.refused ? WISP_NO_MEMORY : status;
}

wisp_status contact_sample_participants( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    wisp_status status = WISP_OK;
    // first count, so that the arrays do not grow while they are filled
    int total = s->point_count;
    for ( int pass = 0; pass < 2 && status == WISP_OK; ++pass )
    {
        s->samples->count = 0;
        if ( pass == 1 && reserve_samples( work, total ) == false )
        {
            return WISP_NO_MEMORY;
        }
        for ( int g = 0; g < work->participant_count && status == WISP_OK; ++g )
        {
            const contact_participant* participant = work->participants + g;
            status = participant->is_strands ? WISP_OK : sample_surface( work, participant );
            const bool has_layer = participant->is_strands == false && status == WISP_OK;
            total += pass == 0 && has_layer ? s->samples->sampler.count : 0;
            if ( pass == 1 && status == WISP_OK )
            {
                add_vertices( s, participant );
                add_samples( s, has_layer ? &s->samples->sampler : NULL, participant->first_point );
            }
        }
    }
    if ( status == WISP_OK )
    {
        place_at_rest( s );
    }
    return status;
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
