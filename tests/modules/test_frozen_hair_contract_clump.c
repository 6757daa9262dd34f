// Frozen hair (Kim 2026, Eq. 14-19 and Algorithm 1): adhesion, gaps, guard, and the pipeline; the engine against
// closed forms through its public interface alone. Eq. 1-13 are in test_frozen_hair_contract.c, which explains how
// tolerances are counted in u = 2^-24.
#include "frozen_hair_contract.h"

// ---- Eq. 14-19: clumping ----

// Pairs of two-vertex strands on a lattice, 3 cm apart and therefore alone: tips r apart along x, roots far above.
typedef struct pair_groom
{
    hair_groom groom;
    int count;
} pair_groom;

static pair_groom make_pairs( int side, float lower, float upper )
{
    int count = side * side;
    SCOPED( free_local ) wisp_vec3* points = calloc( 4 * (size_t)count, sizeof( wisp_vec3 ) );
    SCOPED( free_local ) int* counts = calloc( 2 * (size_t)count, sizeof( int ) );
    assert_true( points != NULL && counts != NULL );
    for ( int n = 0; n < count; ++n )
    {
        float x = 0.03125f * (float)( n % side ), z = 0.03125f * (float)( n / side );
        float half = 0.5f * ( lower + ( upper - lower ) * (float)n / (float)( count > 1 ? count - 1 : 1 ) );
        points[4 * n] = ( wisp_vec3 ){ x, 1.0f, z };
        points[4 * n + 1] = ( wisp_vec3 ){ x - half, 0.0f, z };
        points[4 * n + 2] = ( wisp_vec3 ){ x, 2.0f, z };
        points[4 * n + 3] = ( wisp_vec3 ){ x + half, 0.0f, z };
        counts[2 * n] = counts[2 * n + 1] = 2;
    }
    return ( pair_groom ){ hair_groom_from( 3, 2 * count, counts, points ), count };
}

static wisp_frozen_hair_def one_wet_step( void )
{
    wisp_frozen_hair_def def = hair_clump_only();
    def.clump_iterations = 1;
    def.gap = WISP_GAP_NONE;
    def.min_distance = 0.0f;
    def.clump_step_length = 0.001f;
    return def;
}

// Eq. 14: the kernel, measured by the step of one pair at the origin, so small that the guard allows it
TEST( the_adhesion_kernel_is_one_at_contact_and_leaves_the_radius_smoothly )
{
    wisp_frozen_hair_def def = one_wet_step();
    const double h = (double)def.clump_radius;
    double before = 2.0;
    for ( int n = 0; n <= 120; ++n )
    {
        float r = n == 0 ? 1e-8f : 0.0001f * (float)n;
        def.clump_step_length = fminf( 0.001f, 0.2f * r );
        const double sigma = (double)def.clump_step_length;
        pair_groom pair = make_pairs( 1, r, r );
        wisp_vec3* out = hair_run( NULL, &pair.groom, &def );
        double exact_r = (double)( pair.groom.points[3].x - pair.groom.points[1].x );
        double g = frozen_oracle_kernel( exact_r, h ), root = fmax( 0.0, 1.0 - exact_r / h );
        double seen = hair_distance( out[1], pair.groom.points[1] ) / sigma;
        hair_assert_close( seen, g, 24.0 * u * root + 4.0 * u * ( exact_r + sigma * g ) / sigma + 64.0 * u * u );
        assert_true( seen <= before );
        assert_true( exact_r < h || hair_same_bits( out, pair.groom.points, 4 ) );
        before = seen;
        free( out );
        hair_groom_destroy( &pair.groom );
    }

    // slope 0 at h: at 0.99 h the kernel is 1e-4, not 1e-2
    pair_groom pair = make_pairs( 1, 0.0099f, 0.0099f );
    wisp_vec3* out = hair_run( NULL, &pair.groom, &def );
    hair_assert_close( hair_distance( out[1], pair.groom.points[1] ) / 0.001, 1e-4, 2e-6 );
    free( out );
    hair_groom_destroy( &pair.groom );
}

// Eq. 17-19: the remaining fraction of the step of every vertex of a pair, and its mean over many
TEST( lambda_obeys_the_law_of_the_gap )
{
    pair_groom pairs = make_pairs( 16, 0.002f, 0.006f );
    wisp_frozen_hair_def def = one_wet_step();
    const double h = (double)def.clump_radius;
    wisp_vec3* wet = hair_run( NULL, &pairs.groom, &def );
    def.gap = WISP_GAP_ABSOLUTE;
    for ( int n = 0; n < 2; ++n )
    {
        def.min_lambda = n == 1 ? 0.6f : 0.0f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &pairs.groom, &def );
        double mean = 0.0, expected_mean = 0.0;
        for ( int v = 1; v < 4 * pairs.count; v += 2 )
        {
            const wisp_vec3 p = pairs.groom.points[v];
            double full = hair_distance( wet[v], p ), lambda = hair_distance( out[v], p ) / full;

            // closing in by two full steps
            double delta = 2.0 * full / h, floor = (double)def.min_lambda;
            double law = ( 1.0 - delta ) * draw( 3, v / 2, 1 ) + delta * floor;

            // both steps end in rounded coordinates below half a metre
            hair_assert_close( lambda, law, 4.0 * u * 0.5 / full + 8.0 * u / h );
            mean += lambda / ( 2.0 * pairs.count );
            expected_mean += ( ( 1.0 - delta ) / 2.0 + delta * floor ) / ( 2.0 * pairs.count );
        }
        // three deviations of the mean of 512 uniform numbers
        hair_assert_close( mean, expected_mean, 3.0 / sqrt( 12.0 * 2.0 * pairs.count ) );
    }
    free( wet );
    hair_groom_destroy( &pairs.groom );
}

static double nearest_of_all( const hair_groom* groom, const wisp_vec3* p )
{
    double nearest = INFINITY;
    for ( int s = 0; s < groom->strand_count; ++s )
    {
        for ( int v = groom->offsets[s]; v < groom->offsets[s + 1]; ++v )
        {
            for ( int q = groom->offsets[s + 1]; q < groom->vertex_count; ++q )
            {
                nearest = fmin( nearest, hair_distance( p[v], p[q] ) );
            }
        }
    }
    return nearest;
}

// Eq. 17-19: the guard
TEST( under_the_guard_no_pair_comes_closer_than_allowed_and_none_swaps )
{
    for ( int n = 0; n < 4; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( n % 2 == 0 ? HAIR_WAVY : HAIR_CURLY, 2 + n / 2, 36, 12, 0.003f );
        wisp_frozen_hair_def def = hair_clump_only();
        def.gap = WISP_GAP_NONE;
        def.clump_step_length = 0.05f;
        def.min_distance = 0.0006f;
        double start = nearest_of_all( &groom, groom.points );
        for ( int k = 1; k <= 12; ++k )
        {
            def.clump_iterations = k;
            SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );

            // an iteration may round each of the two coordinates once more
            double slack = 4.0 * u * k * extent( out, groom.vertex_count );
            assert_true( nearest_of_all( &groom, out ) >= fmin( start, (double)def.min_distance ) - slack );
        }
    }

    // a step of fifty times the distance: the pair stops at r_min in its order
    pair_groom pair = make_pairs( 1, 0.001f, 0.001f );
    wisp_frozen_hair_def def = one_wet_step();
    def.clump_step_length = 0.05f;
    def.min_distance = 0.0002f;
    wisp_vec3* kept = hair_run( NULL, &pair.groom, &def );
    hair_assert_close( (double)kept[3].x - (double)kept[1].x, 0.0002, 8.0 * u * 0.001 );
    free( kept );
    hair_groom_destroy( &pair.groom );
}
