// The scalar C version of frozen hair equals the double-precision oracle within the precision of float, so that a
// comparison of times is one of the same method.
//
// Stage 1 has a bound written down term by term (deform_bound). The later stages amplify an error of their input by a
// factor that depends on the scene: a short lever, or a near neighbour. That factor is measured on the oracle, whose
// stages 2 and 3 run from p' with every coordinate shifted at random by up to the stage 1 bound. The bound is four
// deviations of the error of p'; moving all vertices that far leaves room for the roundings of the later stages,
// which are also of the size of a coordinate's last place. The tolerance is the largest offset of any vertex in 4
// such runs.
#include "unit.h"

#include "oracle/frozen_hair_scenes.h"
#include "plain/frozen_hair_plain.h"
#include "wisp/module/random.h"

enum
{
    max_vertices = 1024
};

static double3 widen( wisp_vec3 p )
{
    return double3_make( p.x, p.y, p.z );
}

// The oracle gets exactly the floats of the scalar version.
static frozen_oracle_options widen_options( const plain_frozen_hair_options* o )
{
    static const frozen_oracle_blend blends[] = { FROZEN_ORACLE_BLEND_ARC, FROZEN_ORACLE_BLEND_CHORD };
    static const frozen_oracle_gap gaps[] = { FROZEN_ORACLE_GAP_ABSOLUTE, FROZEN_ORACLE_GAP_SIGNED,
                                              FROZEN_ORACLE_GAP_REVERSED, FROZEN_ORACLE_GAP_NONE };
    static const frozen_oracle_gap_reference references[] = { FROZEN_ORACLE_GAP_REFERENCE_STAGE,
                                                              FROZEN_ORACLE_GAP_REFERENCE_ITERATION };
    frozen_oracle_options wide = frozen_oracle_default_options();
    wide.theta_max = o->theta_max;
    wide.cursor = widen( o->cursor );
    wide.cursor_radius = o->cursor_radius;
    wide.clump_radius = o->clump_radius;
    wide.clump_iterations = o->clump_iterations;
    wide.clump_step = o->clump_step;
    wide.min_distance = o->min_distance;
    wide.lambda_min = o->lambda_min;
    wide.length_floor = o->length_floor;
    wide.dimension = o->dimension;
    wide.blend = blends[o->blend];
    wide.gap = gaps[o->gap];
    wide.gap_reference = references[o->gap_reference];
    wide.min_distance_clamp = o->min_distance_clamp;
    wide.deform = o->deform;
    wide.align = o->align;
    wide.seed = o->seed;
    wide.event = o->event;
    return wide;
}

static plain_frozen_hair create_plain( const frozen_scene* scene, const plain_frozen_hair_options* options )
{
    float xyz[3 * max_vertices], per_strand[3][max_vertices];
    assert_in_range( scene->vertex_count, 1, max_vertices );
    for ( int v = 0; v < scene->vertex_count; ++v )
    {
        xyz[3 * v] = (float)scene->rest[v].x;
        xyz[3 * v + 1] = (float)scene->rest[v].y;
        xyz[3 * v + 2] = (float)scene->rest[v].z;
    }
    for ( int s = 0; s < scene->hair.strand_count; ++s )
    {
        per_strand[0][s] = (float)scene->stretch_stiffness[s];
        per_strand[1][s] = (float)scene->bend_stiffness[s];
        per_strand[2][s] = (float)scene->intensity[s];
    }
    plain_frozen_hair plain;
    assert_true( plain_frozen_hair_create( &plain, scene->hair.strand_count, scene->offsets, xyz, per_strand[0],
                                           per_strand[1], per_strand[2], options ) );
    return plain;
}

static double largest_offset( const double3* expected, const wisp_vec3* actual, int count )
{
    double largest = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        double offset = double3_distance( expected[v], widen( actual[v] ) );
        assert_true( isfinite( offset ) );
        largest = fmax( largest, offset );
    }
    return largest;
}

// Error bound of p'. With u = 2^-24, the unit of rounding: every addition along the strand rounds by at most u
// |coordinate| in each coordinate. The step l* R t has a relative error of at most
//   length:   4 u (square root of a sum of squares) + 2 u alpha (eta) + 3 u (products)                 <= 10 u
//   tangent:  4 u (length) + 2 u (division, product)                                                    =  6 u
//   rotation: 2 u (sine, cosine) + 8 u (products and sums of Eq. 5)                                     = 10 u
//   angle:    theta (2 u + 2 u) + 2 u theta_max alpha (xi)                                    <= 6 u theta_max
//   axis:     (12 u / |t x t| in a bend, 2 pi 2 u + 6 u at a fallback) sin(theta_max alpha)
// Roundings are treated as random, uniformly distributed up to these limits, so that a deviation is a limit divided
// by sqrt 3 and the segments of a strand add as root of the sum of squares. Four deviations are allowed.
static double deform_bound( const frozen_scene* scene, double theta_max )
{
    double unit = 0x1p-24, coordinate = 0.0, worst = 0.0;
    for ( int s = 0; s < scene->hair.strand_count; ++s )
    {
        double sum = 0.0;
        double3 previous = { 0.0, 0.0, 0.0 };
        double turn = sin( fmin( theta_max / scene->bend_stiffness[s], 1.5 ) );
        for ( int v = scene->offsets[s] + 1; v < scene->offsets[s + 1]; ++v )
        {
            double3 d = double3_sub( scene->rest[v], scene->rest[v - 1] );
            double3 tangent = frozen_oracle_tangent( d, previous );
            double sine = double3_length( double3_cross( previous, tangent ) );
            // both precisions must agree on which bends are straight; see the scenes
            assert_true( sine < 1e-9 || sine > 0.01 );
            double axis = sine < 1e-9 ? 19.0 : 12.0 / sine;
            coordinate = fmax( coordinate, double3_length( scene->rest[v] ) + 0.02 );
            double longest = 1.0 + 1.0 / scene->stretch_stiffness[s];
            double step = longest * double3_length( d ) * unit * ( 26.0 + 6.0 * theta_max + axis * turn );
            sum += step * step + 3.0 * coordinate * unit * coordinate * unit;
            previous = tangent;
        }
        worst = fmax( worst, 4.0 * sqrt( sum / 3.0 ) );
    }
    return worst;
}

static double3 shaken( double3 p, double amount, int trial, int v, int dimension )
{
    wisp_random_key key = wisp_random_make_key( 31, 0, (uint64_t)trial );
    double x = wisp_random_unit( key, (uint32_t)v, 0, 0 ), y = wisp_random_unit( key, (uint32_t)v, 1, 0 );
    double z = dimension == 2 ? 0.5 : wisp_random_unit( key, (uint32_t)v, 2, 0 );
    return double3_add( p, double3_scale( 2.0 * amount, double3_make( x - 0.5, y - 0.5, z - 0.5 ) ) );
}

// The largest offset of stages 2 and 3 of the oracle when each coordinate of p' moves by up to amount.
static double amplified( const frozen_scene* scene, frozen_oracle_options options, const double3* deformed,
                         const double3* expected, double amount )
{
    static double3 shifted[max_vertices], out[max_vertices];
    frozen_oracle_hair hair = scene->hair;
    double largest = amount;
    hair.rest = shifted;
    options.deform = false;
    for ( int trial = 0; trial < 4; ++trial )
    {
        for ( int v = 0; v < scene->vertex_count; ++v )
        {
            shifted[v] = shaken( deformed[v], amount, trial, v, options.dimension );
        }
        assert_int_equal( frozen_oracle_run( &hair, &options, NULL, out ), WISP_OK );
        for ( int v = 0; v < scene->vertex_count; ++v )
        {
            largest = fmax( largest, double3_distance( out[v], expected[v] ) );
        }
    }
    return largest;
}

// No decision may depend on a rounding: no tip on the rim of the cursor, and no vertex whose nearest reference
// neighbour is on the rim of the kernel, where Eq. 17 jumps from no neighbour to the full weight of one.
static void assert_decisions_are_clear( const frozen_scene* scene, const frozen_oracle_options* options,
                                        const double3* deformed, const double3* aligned, double margin )
{
    double h = options->clump_radius;
    for ( int s = 0; s < scene->hair.strand_count; ++s )
    {
        for ( int v = scene->offsets[s]; v < scene->offsets[s + 1]; ++v )
        {
            frozen_oracle_options wide = *options;
            wide.clump_radius = 1.5 * h;
            double nearest =
                frozen_oracle_adhere( &scene->hair, &wide, aligned, s, v - scene->offsets[s], NULL ).nearest;
            assert_true( v == scene->offsets[s] || fabs( nearest - h ) > 2.0 * margin );
            assert_true( v + 1 < scene->offsets[s + 1] ||
                         fabs( double3_distance( deformed[v], options->cursor ) - options->cursor_radius ) > margin );
        }
    }
}

// The fraction of the tolerance that the scalar version needs, and the size of the tolerance.
typedef struct agreement
{
    double used;      // largest error / tolerance
    double tolerance; // m, largest tolerance of the last stage
    double moved;     // m, largest displacement of a vertex by clumping, smallest over the runs
} agreement;

static void assert_plain_equals_oracle( const frozen_scene* scene, const plain_frozen_hair_options* options,
                                        agreement* total )
{
    static double3 deformed[max_vertices], aligned[max_vertices], expected[max_vertices];
    frozen_oracle_options wide = widen_options( options ), no_clump = wide;
    plain_frozen_hair plain = create_plain( scene, options );
    assert_true( plain_frozen_hair_run( &plain ) );

    frozen_oracle_deform( &scene->hair, &wide, deformed );
    frozen_oracle_align( &scene->hair, &wide, deformed, aligned );
    assert_int_equal( frozen_oracle_clump( &scene->hair, &wide, aligned, NULL, expected ), WISP_OK );

    double bound = deform_bound( scene, wide.theta_max );
    no_clump.clump = false;
    double tolerances[3] = { bound, amplified( scene, no_clump, deformed, aligned, bound ),
                             amplified( scene, wide, deformed, expected, bound ) };
    assert_decisions_are_clear( scene, &wide, deformed, aligned, tolerances[1] );
    double errors[3] = { largest_offset( deformed, plain.deformed, scene->vertex_count ),
                         largest_offset( aligned, plain.aligned, scene->vertex_count ),
                         largest_offset( expected, plain.position, scene->vertex_count ) };
    for ( int stage = 0; stage < 3; ++stage )
    {
        if ( !( errors[stage] <= tolerances[stage] ) )
        {
            fail_msg( "stage %d is off by %g m, tolerance %g m, blend %d gap %d reference %d guard %d", stage + 1,
                      errors[stage], tolerances[stage], options->blend, options->gap, options->gap_reference,
                      options->min_distance_clamp );
        }
        total->used = fmax( total->used, errors[stage] / tolerances[stage] );
    }
    total->tolerance = fmax( total->tolerance, tolerances[2] );
    double moved = 0.0;
    for ( int v = 0; v < scene->vertex_count; ++v )
    {
        moved = fmax( moved, double3_distance( aligned[v], expected[v] ) );
    }
    total->moved = fmin( total->moved, moved );
    plain_frozen_hair_destroy( &plain );
}

static plain_frozen_hair_options options_for( int dimension )
{
    plain_frozen_hair_options options = plain_frozen_hair_default_options();
    options.dimension = dimension;
    options.cursor = ( wisp_vec3 ){ 0.07f, -0.08f, dimension == 2 ? 0.0f : 0.03f };
    options.cursor_radius = 0.062f;
    options.seed = 17;
    options.event = 3;
    return options;
}

static frozen_scene create_scene( frozen_scene_shape shape, int dimension )
{
    frozen_scene scene;
    assert_true( frozen_scene_create( &scene, shape, dimension, dimension == 2 ? 20 : 25, 12, 0.006 ) );
    return scene;
}

typedef struct hair_kind
{
    frozen_scene_shape shape;
    int dimension;
} hair_kind;

static hair_kind hair_kinds[] = {
    { FROZEN_SCENE_STRAIGHT, 2 }, { FROZEN_SCENE_STRAIGHT, 3 }, { FROZEN_SCENE_WAVY, 2 },
    { FROZEN_SCENE_WAVY, 3 },     { FROZEN_SCENE_CURLY, 2 },    { FROZEN_SCENE_CURLY, 3 },
};

// All 32 settings of blend, gap, gap reference and guard.
static void plain_equals_the_oracle( void** state )
{
    const hair_kind* kind = *state;
    const int dimension = kind->dimension;
    frozen_scene scene = create_scene( kind->shape, dimension );
    agreement total = { 0.0, 0.0, INFINITY };
    for ( int s = 0; s < scene.hair.strand_count; ++s )
    {
        scene.stretch_stiffness[s] = 3.0 + s % 5;
        scene.bend_stiffness[s] = 7.0 - s % 4;
        scene.intensity[s] = ( s % 9 ) / 8.0;
    }
    for ( int n = 0; n < 2 * 4 * 2 * 2; ++n )
    {
        plain_frozen_hair_options options = options_for( dimension );
        options.blend = (plain_hair_blend)( n % 2 );
        options.gap = (plain_hair_gap)( n / 2 % 4 );
        options.gap_reference = (plain_hair_gap_reference)( n / 8 % 2 );
        options.min_distance_clamp = n / 16 == 0;
        assert_plain_equals_oracle( &scene, &options, &total );
    }
    print_message( "           used %.0f %% of the tolerance, at most %.2g m; clumping moves by %.2g m\n",
                   100.0 * total.used, total.tolerance, total.moved );
    // a tolerance beyond 5 % of the effect of clumping would prove nothing
    assert_true( total.tolerance < 0.05 * total.moved );
    frozen_scene_destroy( &scene );
}

static void stages_that_are_off_hand_their_input_on( void** state )
{
    (void)state;
    frozen_scene scene = create_scene( FROZEN_SCENE_WAVY, 3 );
    plain_frozen_hair_options options = options_for( 3 );
    options.deform = options.align = false;
    options.clump_iterations = 0;
    options.clump_radius = 0.0f;
    plain_frozen_hair plain = create_plain( &scene, &options );
    assert_true( plain_frozen_hair_run( &plain ) );
    assert_memory_equal( plain.position, plain.rest, (size_t)scene.vertex_count * sizeof( wisp_vec3 ) );
    assert_true( plain_frozen_hair_mean_neighbours( &plain ) == 0.0 );

    plain.options.align = true;
    assert_true( plain_frozen_hair_run( &plain ) );
    assert_memory_equal( plain.deformed, plain.rest, (size_t)scene.vertex_count * sizeof( wisp_vec3 ) );
    assert_memory_not_equal( plain.position, plain.rest, (size_t)scene.vertex_count * sizeof( wisp_vec3 ) );
    plain_frozen_hair_destroy( &plain );
    frozen_scene_destroy( &scene );
}

// The same floats in the same expression: the count must be exact, for any hash.
static void the_neighbour_figure_is_that_of_brute_force( void** state )
{
    (void)state;
    const float radii[] = { 0.0005f, 0.004f, 0.01f, 0.05f, 10.0f };
    for ( int n = 0; n < 2 * WISP_COUNT( radii ); ++n )
    {
        frozen_scene scene = create_scene( FROZEN_SCENE_CURLY, 2 + n % 2 );
        plain_frozen_hair_options options = options_for( 2 + n % 2 );
        options.clump_radius = radii[n / 2];
        plain_frozen_hair plain = create_plain( &scene, &options );
        assert_true( plain_frozen_hair_run( &plain ) );
        int pairs = 0;
        for ( int v = 0; v < plain.vertex_count; ++v )
        {
            for ( int q = 0; q < plain.vertex_count; ++q )
            {
                float x = plain.aligned[q].x - plain.aligned[v].x, y = plain.aligned[q].y - plain.aligned[v].y;
                float z = plain.aligned[q].z - plain.aligned[v].z, r2 = x * x + y * y + z * z;
                pairs += v / 12 != q / 12 && r2 > 0.0f && r2 < options.clump_radius * options.clump_radius;
            }
        }
        assert_true( plain_frozen_hair_mean_neighbours( &plain ) == (double)pairs / plain.vertex_count );
        assert_true( pairs > 0 || options.clump_radius < 0.001f );
        plain_frozen_hair_destroy( &plain );
        frozen_scene_destroy( &scene );
    }
}

static void a_repeated_run_gives_the_same_bits_and_a_new_event_does_not( void** state )
{
    (void)state;
    frozen_scene scene = create_scene( FROZEN_SCENE_CURLY, 3 );
    plain_frozen_hair_options options = options_for( 3 );
    plain_frozen_hair plain = create_plain( &scene, &options );
    size_t bytes = (size_t)scene.vertex_count * sizeof( wisp_vec3 );
    wisp_vec3 first[max_vertices];
    assert_true( plain_frozen_hair_run( &plain ) );
    memcpy( first, plain.position, bytes );
    plain.options.event += 1;
    assert_true( plain_frozen_hair_run( &plain ) );
    assert_memory_not_equal( first, plain.position, bytes );
    plain.options.event -= 1;
    assert_true( plain_frozen_hair_run( &plain ) );
    assert_memory_equal( first, plain.position, bytes );
    plain_frozen_hair_destroy( &plain );
    frozen_scene_destroy( &scene );
}

static void degenerate_strands_come_out_as_the_oracle_has_them( void** state )
{
    (void)state;
    const int counts[] = { 0, 1, 2, 4, 3, 0, 3, 3 };
    const double step = 0x1p-7, side = 0x1p-9; // exact, so that straight is straight in both precisions
    const double3 points[] = {
        { side, 0, 0 },                                 // one vertex
        { 2 * side, 0, 0 },     { 2 * side, -step, 0 }, // one segment
        { 3 * side, 0, 0 },     { 3 * side, 0, 0 },     { 3 * side, -step, 0 },
        { 3 * side, -step, 0 },                                                                 // zero, real, zero
        { 4 * side, 0, 0 },     { 4 * side, -step, 0 }, { 4 * side, -2 * step, 0 },             // collinear
        { 4 * side, 0, 0 },     { 4 * side, -step, 0 }, { 4 * side, -2 * step, 0 },             // the same again
        { 5 * side, 0, 0 },     { 5 * side, -step, 0 }, { 5 * side + step / 32, -2 * step, 0 }, // hardly bent
    };
    frozen_scene scene;
    assert_true( frozen_scene_from_points( &scene, 8, counts, points ) );
    agreement total = { 0.0, 0.0, INFINITY };
    for ( int n = 0; n < 2 * 4; ++n )
    {
        plain_frozen_hair_options options = options_for( 2 + n % 2 );
        options.gap = (plain_hair_gap)( n / 2 );
        options.cursor_radius = 1.0f;
        assert_plain_equals_oracle( &scene, &options, &total );
    }
    assert_true( total.tolerance < 0.05 * total.moved );
    frozen_scene_destroy( &scene );

    // wholly coincident strands, before any stage separates them, have no direction
    plain_frozen_hair plain;
    const int offsets[] = { 0, 2, 4 };
    const float twins[] = { 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, -1, 0 };
    plain_frozen_hair_options options = options_for( 3 );
    options.deform = false;
    assert_true( plain_frozen_hair_create( &plain, 2, offsets, twins, NULL, NULL, NULL, &options ) );
    assert_true( plain_frozen_hair_run( &plain ) );
    assert_memory_equal( plain.position, twins, sizeof( twins ) );
    plain_frozen_hair_destroy( &plain );
}

static void empty_hair_is_a_no_op_and_wrong_input_is_refused( void** state )
{
    (void)state;
    plain_frozen_hair plain;
    const int nothing[] = { 0 }, one[] = { 0, 2 };
    plain_frozen_hair_options options = options_for( 3 );
    assert_true( plain_frozen_hair_create( &plain, 0, nothing, NULL, NULL, NULL, NULL, &options ) );
    assert_true( plain_frozen_hair_run( &plain ) );
    assert_true( plain_frozen_hair_mean_neighbours( &plain ) == 0.0 );
    plain_frozen_hair_destroy( &plain );

    const float xyz[] = { 0, 0, 0, 0, -1, 0 };
    assert_true( plain_frozen_hair_create( &plain, 1, one, xyz, NULL, NULL, NULL, &options ) );
    assert_true( plain_frozen_hair_run( &plain ) );
    plain.options.clump_radius = 0.0f;
    assert_false( plain_frozen_hair_run( &plain ) );
    plain.options.clump_radius = 0.01f;
    plain.options.theta_max = NAN;
    assert_false( plain_frozen_hair_run( &plain ) );
    plain.options.theta_max = 1.0f;
    plain.stretch_stiffness[0] = 0.0f;
    assert_false( plain_frozen_hair_run( &plain ) );
    plain.stretch_stiffness[0] = 7.0f;
    plain.rest[1].x = INFINITY;
    assert_false( plain_frozen_hair_run( &plain ) );
    plain_frozen_hair_destroy( &plain );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        { "plain_equals_the_oracle_on_straight_hair_in_the_plane", plain_equals_the_oracle, NULL, NULL,
          &hair_kinds[0] },
        { "plain_equals_the_oracle_on_straight_hair_in_space", plain_equals_the_oracle, NULL, NULL, &hair_kinds[1] },
        { "plain_equals_the_oracle_on_wavy_hair_in_the_plane", plain_equals_the_oracle, NULL, NULL, &hair_kinds[2] },
        { "plain_equals_the_oracle_on_wavy_hair_in_space", plain_equals_the_oracle, NULL, NULL, &hair_kinds[3] },
        { "plain_equals_the_oracle_on_curly_hair_in_the_plane", plain_equals_the_oracle, NULL, NULL, &hair_kinds[4] },
        { "plain_equals_the_oracle_on_curly_hair_in_space", plain_equals_the_oracle, NULL, NULL, &hair_kinds[5] },
        cmocka_unit_test( stages_that_are_off_hand_their_input_on ),
        cmocka_unit_test( the_neighbour_figure_is_that_of_brute_force ),
        cmocka_unit_test( a_repeated_run_gives_the_same_bits_and_a_new_event_does_not ),
        cmocka_unit_test( degenerate_strands_come_out_as_the_oracle_has_them ),
        cmocka_unit_test( empty_hair_is_a_no_op_and_wrong_input_is_refused ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
