// Boundary particles as what is kept apart: vertices, and points on edges and in triangles that stand between them by
// weights. Balls at these points stand for the surface, which is several times cheaper than the surface itself and lets pass
// what is finer than their spacing.
#include "contact_internal.h"

#include <string.h>

// ---- sampling, at rest ----

static bool reserve_samples( const contact_work* work, int count )
{
    contact_soup* s = work->soup;
    return contact_reserve( work, CONTACT_SAMPLE_PARENTS, (size_t)count * sizeof( *s->sample_parents ),
                            (void**)&s->sample_parents ) &&
           contact_reserve( work, CONTACT_SAMPLE_WEIGHTS, (size_t)count * sizeof( *s->sample_weights ),
                            (void**)&s->sample_weights ) &&
           contact_reserve( work, CONTACT_SAMPLE_RESTS, (size_t)count * sizeof( *s->sample_rests ),
                            (void**)&s->sample_rests ) &&
           contact_reserve( work, CONTACT_SAMPLE_PLACES, (size_t)count * sizeof( *s->sample_places ),
                            (void**)&s->sample_places ) &&
           contact_reserve( work, CONTACT_SAMPLE_WAYS, (size_t)count * sizeof( float ), (void**)&s->sample_ways ) &&
           contact_reserve( work, CONTACT_SAMPLE_BOXES, (size_t)count * sizeof( wisp_box ),
                            (void**)&s->sample_boxes );
}

static void add_vertices( contact_soup* s, const contact_guest* guest )
{
    for ( int i = 0; i < guest->point_count; ++i )
    {
        const int point = guest->first_point + i, sample = s->sample_count++;
        for ( int k = 0; k < 3; ++k )
        {
            s->sample_parents[sample][k] = point;
            s->sample_weights[sample][k] = k == 0 ? 1.0f : 0.0f;
        }
    }
}

static void add_samples( contact_soup* s, const wisp_samples* layer, int first_point )
{
    for ( int i = 0; layer != NULL && i < layer->count; ++i )
    {
        const int sample = s->sample_count++;
        for ( int k = 0; k < 3; ++k )
        {
            s->sample_parents[sample][k] = first_point + layer->parents[i][k] / 4;
            s->sample_weights[sample][k] = layer->weights[i][k];
        }
    }
}

static void place_at_rest( contact_soup* s )
{
    for ( int i = 0; i < s->sample_count; ++i )
    {
        contact_place_sample( s, s->rest, i, s->sample_rests[i] );
        s->sample_rests[i][3] = s->rest[(size_t)s->sample_parents[i][0] * 4 + 3];
    }
}

// A job remembers counts from call to call; this one is made once.
static wisp_status sample_surface( const contact_work* work, const contact_guest* guest )
{
    enum
    {
        NUMBERS_AN_EDGE = 2,
        NUMBERS_A_TRIANGLE = 4,
        MOST_SAMPLES = 1 << 22,
    };
    contact_soup* s = work->soup;
    const wisp_fabric* f = wisp_frame_fabric( work->frame, guest->entity );
    const size_t edges = (size_t)f->edge_count, triangles = (size_t)f->triangle_count;
    const size_t numbers = edges * NUMBERS_AN_EDGE + triangles * NUMBERS_A_TRIANGLE;
    float* scratch = wisp_parallel_scratch( work->parallel, work->worker, ( numbers + 1 ) * sizeof( float ) );
    if ( scratch == NULL )
    {
        return WISP_NO_MEMORY;
    }
    memset( scratch, 0, numbers * sizeof( float ) );
    const float wanted = work->state->world.sample_spacing;
    int32_t* counts = (int32_t*)(void*)( scratch + edges + 2 * triangles );
    const wisp_samples_job job = {
        .position = s->rest + (size_t)guest->first_point * 4,
        .edges = f->edges,
        .edge_count = f->edge_count,
        .triangles = f->triangles,
        .triangle_count = f->triangle_count,
        .spacing = wanted > 0.0f ? wanted : s->least_thickness,
        .rounding = WISP_ROUND_UP,
        .limit = MOST_SAMPLES,
        .edge_length = scratch,
        .triangle_extent = scratch + edges,
        .edge_points = counts,
        .triangle_points = counts + edges,
        .triangle_axis = counts + edges + triangles,
    };
    const wisp_status status =
        wisp_samples_update( &s->sampler, work->parallel, wisp_frame_kernels( work->frame ), &job );
    return status == WISP_OK && s->sampler.refused ? WISP_NO_MEMORY : status;
}

wisp_status contact_sample_guests( const contact_work* work )
{
    contact_soup* s = work->soup;
    wisp_status status = WISP_OK;
    // counted first, so that the arrays do not grow under way
    int total = s->point_count;
    for ( int pass = 0; pass < 2 && status == WISP_OK; ++pass )
    {
        s->sample_count = 0;
        if ( pass == 1 && reserve_samples( work, total ) == false )
        {
            return WISP_NO_MEMORY;
        }
        for ( int g = 0; g < work->state->guest_count && status == WISP_OK; ++g )
        {
            const contact_guest* guest = work->state->guests + g;
            status = guest->is_strands ? WISP_OK : sample_surface( work, guest );
            const bool has_layer = guest->is_strands == false && status == WISP_OK;
            total += pass == 0 && has_layer ? s->sampler.count : 0;
            if ( pass == 1 && status == WISP_OK )
            {
                add_vertices( s, guest );
                add_samples( s, has_layer ? &s->sampler : NULL, guest->first_point );
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

void contact_place_sample( const contact_soup* s, const float* quads, int sample, float out[3] )
{
    const int32_t* parents = s->sample_parents[sample];
    const float* weights = s->sample_weights[sample];
    for ( size_t k = 0; k < 3; ++k )
    {
        const float o = quads[(size_t)parents[0] * 4 + k];
        out[k] = o + weights[1] * ( quads[(size_t)parents[1] * 4 + k] - o ) +
                 weights[2] * ( quads[(size_t)parents[2] * 4 + k] - o );
    }
}

float contact_sample_distance( const contact_soup* s, const float* quads, int a, int b )
{
    float p[3], q[3];
    contact_place_sample( s, quads, a, p );
    contact_place_sample( s, quads, b, q );
    return contact_distance( p, q );
}

// Particles of a guest that are neighbours at rest would hold it stiff, and they always are within reach: what is nearer at
// rest than that is no pair.
float contact_sample_gap_of( const contact_work* work, int a, int b )
{
    const contact_soup* s = work->soup;
    static const float REST_GAPS = 2.0f;
    const float *p = s->sample_rests[a], *q = s->sample_rests[b];
    const contact_guest *ga = work->state->guests + (int)p[3], *gb = work->state->guests + (int)q[3];
    const float gap = 0.5f * ( ga->settings.thickness + gb->settings.thickness );
    const float apart = REST_GAPS * gap + s->least_thickness;
    const bool is_pair = contact_may_meet( ga, gb ) && ( ga != gb || contact_distance( p, q ) > apart );
    return is_pair ? gap : 0.0f;
}

void contact_measure_samples( const contact_soup* s, const float* quads, const contact_pair* pair, contact_row* row )
{
    float p[3], q[3];
    contact_place_sample( s, quads, pair->a, p );
    contact_place_sample( s, quads, pair->b, q );
    const float d[3] = { p[0] - q[0], p[1] - q[1], p[2] - q[2] };
    row->distance = sqrtf( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
    for ( int k = 0; k < 3; ++k )
    {
        row->weight[k] = s->sample_weights[pair->a][k];
        row->weight[3 + k] = -s->sample_weights[pair->b][k];
        row->normal[k] = row->distance > 0.0f ? d[k] / row->distance : 0.0f;
    }
}
