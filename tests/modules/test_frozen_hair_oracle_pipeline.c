// Frozen hair as a whole, on the oracle: order and switches of the stages, the overshoot guard, reproducibility,
// degenerate hair, rejected input. Numbers of equations and figures are those of Kim 2026.
#include "frozen_hair_fixture.h"

// Options under which all three stages have an effect in the scenes of this file.
static frozen_oracle_options busy_options( int dimension )
{
    frozen_oracle_options options = frozen_oracle_default_options();
    options.dimension = dimension;
    options.cursor = double3_make( 0.05, -0.1, dimension == 2 ? 0.0 : 0.02 );
    options.cursor_radius = 0.12;
    options.seed = 5;
    options.event = 11;
    return options;
}

// Algorithm 1: FreezeDeform, UserAlign, ClumpWithGaps, each of which may be off
static void the_pipeline_is_its_stages_in_their_order( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 25, 20, 0.006 );
    double3 *p = new_points( &scene ), *q = new_points( &scene );
    for ( int stages = 0; stages < 8; ++stages )
    {
        frozen_oracle_options options = busy_options( 3 );
        options.deform = ( stages & 1 ) != 0;
        options.align = ( stages & 2 ) != 0;
        options.clump = ( stages & 4 ) != 0;
        size_t bytes = (size_t)scene.vertex_count * sizeof( double3 );

        memcpy( p, scene.rest, bytes );
        if ( options.deform )
        {
            frozen_oracle_deform( &scene.hair, &options, p );
        }
        memcpy( q, p, bytes );
        if ( options.align )
        {
            frozen_oracle_align( &scene.hair, &options, p, q );
        }
        memcpy( p, q, bytes );
        if ( options.clump )
        {
            assert_int_equal( frozen_oracle_clump( &scene.hair, &options, q, NULL, p ), WISP_OK );
        }

        double3* out = run( &scene, &options );
        assert_true( same_bits( out, p, scene.vertex_count ) );
        assert_int_equal( same_bits( out, scene.rest, scene.vertex_count ), stages == 0 );
        free( out );
    }
    free( p );
    free( q );
    frozen_scene_destroy( &scene );
}

// Algorithm 1: aligning before deforming gives another result, so the order matters
static void aligning_before_deforming_is_not_the_method( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 25, 20, 0.006 );
    frozen_oracle_options options = busy_options( 3 );
    options.clump = false;
    double3* right = run( &scene, &options );
    double3 *aligned = new_points( &scene ), *wrong = new_points( &scene );
    frozen_oracle_align( &scene.hair, &options, scene.rest, aligned );
    frozen_oracle_hair turned = scene.hair;
    turned.rest = aligned;
    frozen_oracle_deform( &turned, &options, wrong );
    assert_false( same_bits( right, wrong, scene.vertex_count ) );
    free( right );
    free( aligned );
    free( wrong );
    frozen_scene_destroy( &scene );
}

// Nothing changes without a command, and a command always starts from rest
static void the_same_command_gives_the_same_bits_and_another_command_does_not( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 25, 20, 0.006 );
    frozen_oracle_options options = busy_options( 3 );
    double3* first = run( &scene, &options );
    double3* again = run( &scene, &options );
    assert_true( same_bits( first, again, scene.vertex_count ) );
    free( again );

    options.event += 1;
    double3* next = run( &scene, &options );
    assert_false( same_bits( first, next, scene.vertex_count ) );
    options.event -= 1;
    again = run( &scene, &options );
    assert_true( same_bits( first, again, scene.vertex_count ) );

    // base = rest does not read the previous output
    scene.hair.previous = next;
    double3* with_previous = run( &scene, &options );
    assert_true( same_bits( first, with_previous, scene.vertex_count ) );
    free( first );
    free( again );
    free( next );
    free( with_previous );
    frozen_scene_destroy( &scene );
}

// Random numbers depend on the strand, not on the order of work
static void strands_may_be_worked_off_in_any_order( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_CURLY, 3, 25, 20, 0.006 );
    frozen_oracle_options options = busy_options( 3 );
    options.clump = false;
    double3* forward = run( &scene, &options );
    double3 *p = new_points( &scene ), *backward = new_points( &scene );
    for ( int s = 24; s >= 0; --s )
    {
        frozen_oracle_deform_strand( &scene.hair, &options, s, p );
        frozen_oracle_align_strand( &scene.hair, &options, s, p, backward );
    }
    assert_true( same_bits( forward, backward, scene.vertex_count ) );

    options.seed += 1;
    double3* other = run( &scene, &options );
    for ( int s = 0; s < 25; ++s )
    {
        assert_false( same_bits( forward + 20 * s, other + 20 * s, 20 ) );
    }
    free( forward );
    free( backward );
    free( other );
    free( p );
    frozen_scene_destroy( &scene );
}

// The four streams and the three element numbers are independent of each other
static void every_random_number_has_its_own_key( void** state )
{
    (void)state;
    frozen_oracle_options options = busy_options( 3 ), next = options;
    next.event += 1;
    double eta = frozen_oracle_eta( &options, 3, 4 ), xi = frozen_oracle_xi( &options, 3, 4 );
    double zeta = frozen_oracle_zeta( &options, 3, 4, 0 ), psi = frozen_oracle_psi( &options, 3, 4 );
    assert_true( eta != xi && eta != 2.0 * zeta - 1.0 && xi != 2.0 * zeta - 1.0 );
    assert_true( eta != frozen_oracle_eta( &options, 4, 3 ) && zeta != frozen_oracle_zeta( &options, 3, 4, 1 ) );
    assert_true( eta != frozen_oracle_eta( &next, 3, 4 ) && xi != frozen_oracle_xi( &next, 3, 4 ) );
    assert_true( zeta != frozen_oracle_zeta( &next, 3, 4, 0 ) );
    // the fallback axis depends on the hair and stays the same after the command
    assert_true( psi == frozen_oracle_psi( &next, 3, 4 ) && psi != frozen_oracle_psi( &next, 3, 5 ) );
}

// Section III.3: k_s, k_b and x are the strand's own
static void each_strand_obeys_its_own_stiffness_and_intensity( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_STRAIGHT, 2, 20, 20, 0.008 );
    frozen_oracle_options options = busy_options( 2 );
    options.cursor_radius = 1.0;
    double3 *bent = new_points( &scene ), *turned = new_points( &scene );
    for ( int s = 0; s < 20; ++s )
    {
        scene.stretch_stiffness[s] = s % 2 == 0 ? 3.0 : 1e12;
        scene.bend_stiffness[s] = s % 3 == 0 ? 1e12 : 3.0;
        scene.intensity[s] = s / 19.0;
    }
    frozen_oracle_deform( &scene.hair, &options, bent );
    frozen_oracle_align( &scene.hair, &options, scene.rest, turned );
    for ( int s = 0; s < 20; ++s )
    {
        const double3 *rest = scene.rest + 20 * s, *p = bent + 20 * s, *q = turned + 20 * s;
        double stretch = 0.0, bend = 0.0;
        for ( int i = 1; i < 20; ++i )
        {
            double3 d = double3_sub( p[i], p[i - 1] ), d0 = double3_sub( rest[i], rest[i - 1] );
            stretch = fmax( stretch, fabs( double3_length( d ) / double3_length( d0 ) - 1.0 ) );
            bend = fmax( bend, double3_angle( d, d0 ) );
        }
        assert_true( s % 2 == 0 ? stretch > 0.2 && stretch <= 1.0 / 3.0 : stretch < 1e-10 );
        assert_true( s % 3 == 0 ? bend < 1e-10 : bend > 0.15 && bend <= options.theta_max / 3.0 );

        double phi = double3_angle( double3_sub( rest[19], rest[0] ), double3_sub( options.cursor, rest[0] ) );
        double near_root = double3_angle( double3_sub( rest[1], rest[0] ), double3_sub( q[1], q[0] ) );
        assert_close( near_root, frozen_oracle_weight( 1, 20, s / 19.0 ) * phi, 1e-9 );
    }
    free( bent );
    free( turned );
    frozen_scene_destroy( &scene );
}

// Base = previous lets bends accumulate, while lengths stay bound to the rest lengths
static void starting_from_the_previous_output_drifts_in_angle_but_not_in_length( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_STRAIGHT, 2, 20, 20, 0.008 );
    frozen_oracle_options options = busy_options( 2 );
    options.align = options.clump = false;
    options.base = FROZEN_ORACLE_BASE_PREVIOUS;
    double3* shape = new_points( &scene );
    memcpy( shape, scene.rest, (size_t)scene.vertex_count * sizeof( double3 ) );
    scene.hair.previous = shape;
    for ( int event = 0; event < 50; ++event )
    {
        options.event = (uint64_t)event;
        double3* next = run( &scene, &options );
        memcpy( shape, next, (size_t)scene.vertex_count * sizeof( double3 ) );
        free( next );
    }
    double sum = 0.0;
    for ( int v = 0; v < scene.vertex_count; ++v )
    {
        if ( v % 20 > 0 )
        {
            double3 d = double3_sub( shape[v], shape[v - 1] ), d0 = double3_sub( scene.rest[v], scene.rest[v - 1] );
            // 1e-12 is the rounding of the coordinates relative to a segment of 7 mm
            assert_true( fabs( double3_length( d ) / double3_length( d0 ) - 1.0 ) <= 1.0 / 7.0 + 1e-12 );
            double angle = double3_angle( d, d0 );
            sum += angle * angle;
        }
    }
    // a random walk of 50 steps of variance (theta_max alpha)^2 / 3 over 380 segments: the mean square has a relative
    // deviation of at most sqrt( 2 / 380 ), three of which are 22 %
    double step = options.theta_max / 7.0;
    assert_close( sum / 380.0 / ( 50.0 * step * step / 3.0 ), 1.0, 3.0 * sqrt( 2.0 / 380.0 ) );
    free( shape );
    frozen_scene_destroy( &scene );
}

// Discussion, 2D and 3D
static void flat_hair_stays_flat_and_hair_in_space_does_not( void** state )
{
    (void)state;
    for ( int n = 0; n < 3 * 2 * 4 * 2; ++n )
    {
        frozen_scene scene = new_scene( (frozen_scene_shape)( n % 3 ), 2, 20, 20, 0.004 );
        frozen_oracle_options options = busy_options( 2 );
        options.blend = (frozen_oracle_blend)( n / 3 % 2 );
        options.gap = (frozen_oracle_gap)( n / 6 % 4 );
        options.epsilon = n / 24 == 0 ? 0.0 : 1e-6;
        double3* out = run( &scene, &options );
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            assert_true( out[v].z == 0.0 );
        }
        free( out );

        // the same hair in space gets fallback axes outside the plane
        options.dimension = 3;
        out = run( &scene, &options );
        assert_true( out[19].z != 0.0 );
        free( out );
        frozen_scene_destroy( &scene );
    }
}

static void assert_refused( const frozen_scene* scene, const frozen_oracle_options* options, const char* named )
{
    wisp_error error = { WISP_OK, "" };
    double3* out = new_points( scene );
    assert_int_equal( frozen_oracle_run( &scene->hair, options, NULL, out, &error ), WISP_BAD_INPUT );
    assert_int_equal( error.status, WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, named ) );
    assert_true( out[0].x == 0.0 && out[1].y == 0.0 );
    free( out );
}

// 2.5D (extension)
static void a_limit_of_depth_keeps_z_near_and_lengths_as_they_were( void** state )
{
    (void)state;
    // level, too deep, steeper than its length, without x and y, and back
    const double3 base[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 3 }, { 4, 0, 3 }, { 5, 0, 3 } };
    const double3 frozen[] = { { 0, 0, 0 },       { 0.6, 0.8, 0 },   { 1.2, 0.8, 0.8 },
                               { 2.2, 0.8, 0.8 }, { 2.2, 0.8, 2.8 }, { 2.2, 1.8, 2.8 } };
    double3 p[6];
    memcpy( p, frozen, sizeof p );
    frozen_oracle_limit_depth( base, 6, 10.0, p );
    assert_true( same_bits( p, frozen, 6 ) );
    frozen_oracle_limit_depth( base, 6, 0.5, p );
    assert_true( same_bits( p, frozen, 2 ) );
    assert_true( p[2].z == 0.5 && p[3].z == 2.5 && p[4].z == 2.8 && p[5].z == 2.8 );
    assert_close( double3_distance( p[2], p[1] ), 1.0, 1e-15 );
    assert_close( p[2].x - p[1].x, sqrt( 0.75 ), 1e-15 );
    assert_true( p[3].x == p[2].x && p[3].y == p[2].y && p[4].x == p[3].x );
    assert_close( p[5].y - p[4].y, 1.0, 1e-15 );

    for ( int n = 0; n < 1000; ++n )
    {
        const double3 t = double3_unit( random_vector( n, 0 ) ), axis = frozen_oracle_upright_axis( t );
        assert_close( double3_length( axis ), 1.0, 1e-12 );
        assert_close( double3_dot( axis, t ), 0.0, 1e-12 );
        assert_close( double3_cross( axis, t ).z, 0.0, 1e-12 );
        assert_true( axis.z > 0.0 );
    }
    const double3 up = { 0.0, 0.0, 1.0 }, any = frozen_oracle_upright_axis( up );
    assert_true( double3_length( any ) == 1.0 && any.z == 0.0 );
}

static void with_a_limit_every_stage_leaves_depth_alone( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_CURLY, 3, 49, 20, 0.004 );
    for ( int n = 0; n < 3; ++n )
    {
        const double limits[] = { 0.0, 1e-3, -1.0 };
        frozen_oracle_options options = busy_options( 3 );
        options.cursor = double3_make( 0.1, -0.1, 0.3 );
        options.cursor_radius = 1.0;
        options.max_depth_change = limits[n];
        double3* out = run( &scene, &options );
        double most = 0.0;
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            most = fmax( most, fabs( out[v].z - scene.rest[v].z ) );
        }
        assert_true( n == 2 ? most > 0.01 : most <= limits[n] + 1e-16 );
        free( out );
    }
    frozen_oracle_options options = busy_options( 3 );
    options.max_depth_change = 2e6;
    assert_refused( &scene, &options, "change of depth" );
    options.max_depth_change = NAN;
    assert_refused( &scene, &options, "change of depth" );
    frozen_scene_destroy( &scene );
}

// Dense hair with deliberately little space: r_min and less between many vertices.
static frozen_scene crowded_scene( void )
{
    double3 points[40 * 6];
    int counts[40];
    for ( int s = 0; s < 40; ++s )
    {
        counts[s] = 6;
        for ( int i = 0; i < 6; ++i )
        {
            double3 shake = double3_scale( 0.003, random_vector( 6 * s + i, 0 ) );
            points[6 * s + i] = double3_add( double3_make( 0.0, -0.002 * i, 0.0 ), shake );
        }
    }
    // two tips closer than r_min from the start
    points[11] = double3_add( points[5], double3_make( 0.0001, 0.0, 0.0 ) );
    return new_scene_from( 40, counts, points );
}

// Number of pairs that come closer than min(start, r_min), and that pass each other, in K steps of clumping.
static void count_violations( const frozen_scene* scene, const frozen_oracle_options* options, int* too_close,
                              int* swapped )
{
    double3 *p = new_points( scene ), *next = new_points( scene );
    memcpy( p, scene->rest, (size_t)scene->vertex_count * sizeof( double3 ) );
    *too_close = *swapped = 0;
    for ( int k = 0; k < options->clump_iterations; ++k )
    {
        clump_step( scene, options, k, scene->rest, p, NULL, NULL, next );
        for ( int v = 0; v < scene->vertex_count; ++v )
        {
            for ( int q = 0; q < v; ++q )
            {
                double3 before = double3_sub( p[q], p[v] ), after = double3_sub( next[q], next[v] );
                double floor_distance =
                    fmin( double3_distance( scene->rest[q], scene->rest[v] ), options->min_distance );
                if ( !same_strand( scene, v, q ) )
                {
                    // 1e-15 m is the rounding of coordinates below one metre
                    *too_close += double3_length( after ) < floor_distance - 1e-15;
                    *swapped += double3_dot( before, after ) <= 0.0;
                }
            }
        }
        memcpy( p, next, (size_t)scene->vertex_count * sizeof( double3 ) );
    }
    free( p );
    free( next );
}

// Eq. 17-19: the guard
static void the_guard_keeps_pairs_apart_and_in_order_and_nothing_else_does( void** state )
{
    (void)state;
    frozen_scene scene = crowded_scene();
    for ( int gap = FROZEN_ORACLE_GAP_ABSOLUTE; gap <= FROZEN_ORACLE_GAP_NONE; ++gap )
    {
        frozen_oracle_options options = busy_options( 3 );
        int too_close, swapped;
        options.gap = (frozen_oracle_gap)gap;
        options.clump_iterations = 10;
        count_violations( &scene, &options, &too_close, &swapped );
        assert_int_equal( too_close, 0 );
        assert_int_equal( swapped, 0 );

        options.min_distance_clamp = false;
        count_violations( &scene, &options, &too_close, &swapped );
        assert_true( too_close > 0 && swapped > 0 );
    }
    frozen_scene_destroy( &scene );
}

// A single vertex, none, a single segment, a segment without length, coincident and collinear vertices
static void degenerate_strands_come_out_finite_and_as_agreed( void** state )
{
    (void)state;
    const int counts[] = { 0, 1, 2, 4, 3, 0, 3 };
    const double3 points[] = {
        { 0.001, 0, 0 },                                                                // 0: one vertex
        { 0.002, 0, 0 }, { 0.002, -0.01, 0 },                                           // 1, 2: one segment
        { 0.003, 0, 0 }, { 0.003, 0, 0 },     { 0.003, -0.01, 0 }, { 0.003, -0.01, 0 }, // 3..6: zero, real, zero
        { 0.004, 0, 0 }, { 0.004, -0.01, 0 }, { 0.004, -0.02, 0 },                      // 7..9: collinear
        { 0.004, 0, 0 }, { 0.004, -0.01, 0 }, { 0.004, -0.02, 0 },                      // 10..12: the same again
    };
    frozen_scene scene = new_scene_from( 7, counts, points );
    for ( int n = 0; n < 2 * 4 * 2 * 2; ++n )
    {
        frozen_oracle_options options = busy_options( 2 + n % 2 );
        options.gap = (frozen_oracle_gap)( n / 2 % 4 );
        options.min_distance_clamp = n / 8 % 2 == 0;
        options.epsilon = n / 16 == 0 ? 0.0 : 1e-6;
        double3* out = run( &scene, &options );
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            assert_true( isfinite( out[v].x ) && isfinite( out[v].y ) && isfinite( out[v].z ) );
        }
        assert_true( same_bits( out, points, 2 ) && same_bits( out + 3, points + 3, 1 ) );
        assert_true( same_bits( out + 7, points + 7, 1 ) && same_bits( out + 10, points + 10, 1 ) );
        free( out );

        // zero stays zero, and a lone segment still bends about its fallback axis
        options.align = options.clump = false;
        out = run( &scene, &options );
        assert_true( same_bits( out + 4, out + 3, 1 ) && same_bits( out + 6, out + 5, 1 ) );
        assert_true( double3_angle( double3_sub( out[2], out[1] ), double3_make( 0, -1, 0 ) ) > 1e-4 );
        free( out );

        // wholly coincident strands do not pull each other
        options.deform = false;
        frozen_oracle_adhesion a = frozen_oracle_adhere( &scene.hair, &options, scene.rest, 4, 1, NULL );
        assert_true( a.nearest > 0.0 && isfinite( a.force.x ) );
    }
    frozen_scene_destroy( &scene );
}

// Empty hair, no neighbours, cursor on the root, K = 0
static void stages_without_anything_to_do_change_nothing( void** state )
{
    (void)state;
    frozen_oracle_options options = busy_options( 3 );
    frozen_oracle_hair nothing = { 0 };
    assert_int_equal( frozen_oracle_run( &nothing, &options, NULL, NULL, NULL ), WISP_OK );

    frozen_scene scene = new_scene( FROZEN_SCENE_STRAIGHT, 3, 9, 20, 0.05 );
    options.deform = options.align = false;
    double3* lonely = run( &scene, &options );
    assert_true( same_bits( lonely, scene.rest, scene.vertex_count ) );

    options.clump_iterations = 0;
    options.clump_radius = 0.0;
    options.align = true;
    options.cursor = scene.rest[0];
    options.cursor_radius = 1.0;
    double3* aligned = run( &scene, &options );
    assert_true( same_bits( aligned, scene.rest, 20 ) ); // strand 0 has its root under the cursor
    assert_false( same_bits( aligned + 20, scene.rest + 20, 20 ) );
    free( lonely );
    free( aligned );
    frozen_scene_destroy( &scene );
}

// Invalid input is rejected with a message that names it
static void wrong_parameters_and_wrong_points_are_refused_by_name( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 4, 20, 0.006 );
    const frozen_oracle_options good = busy_options( 3 );
    const struct
    {
        const char* named;
        size_t field;
        double value;
    } wrong[] = {
        { "theta_max", offsetof( frozen_oracle_options, theta_max ), 3.2 },
        { "theta_max", offsetof( frozen_oracle_options, theta_max ), NAN },
        { "cursor radius", offsetof( frozen_oracle_options, cursor_radius ), -0.1 },
        { "cursor is", offsetof( frozen_oracle_options, cursor ), INFINITY },
        { "clump radius", offsetof( frozen_oracle_options, clump_radius ), 0.0 },
        { "clump step", offsetof( frozen_oracle_options, clump_step ), NAN },
        { "guard distance", offsetof( frozen_oracle_options, min_distance ), -1.0 },
        { "lambda_min", offsetof( frozen_oracle_options, lambda_min ), 1.5 },
        { "length floor", offsetof( frozen_oracle_options, length_floor ), 1.5 },
        { "epsilon", offsetof( frozen_oracle_options, epsilon ), -1e-6 },
    };
    for ( int n = 0; n < WISP_COUNT( wrong ); ++n )
    {
        frozen_oracle_options options = good;
        memcpy( (char*)&options + wrong[n].field, &wrong[n].value, sizeof( double ) );
        assert_refused( &scene, &options, wrong[n].named );
    }

    double* per_strand[] = { scene.stretch_stiffness, scene.bend_stiffness, scene.intensity };
    const double beyond[][3] = { { 0.0, -1.0, NAN }, { 0.0, 1e13, NAN }, { -0.1, 1.1, NAN } };
    for ( int n = 0; n < 9; ++n )
    {
        double kept = per_strand[n / 3][2];
        per_strand[n / 3][2] = beyond[n / 3][n % 3];
        assert_refused( &scene, &good, "strand 2" );
        per_strand[n / 3][2] = kept;
    }

    scene.rest[20 * 3 + 7].y = NAN;
    assert_refused( &scene, &good, "strand 3, vertex 7" );
    scene.rest[20 * 3 + 7].y = 2e6;
    assert_refused( &scene, &good, "strand 3, vertex 7" );
    scene.rest[20 * 3 + 7].y = 0.0;
    frozen_oracle_options options = good;
    options.base = FROZEN_ORACLE_BASE_PREVIOUS;
    assert_refused( &scene, &options, "previous" );
    options = good;
    options.clump_iterations = 1001;
    assert_refused( &scene, &options, "clump iterations" );
    options.clump_iterations = -1;
    assert_refused( &scene, &options, "clump iterations" );
    options = good;
    options.dimension = 4;
    assert_refused( &scene, &options, "dimension" );
    scene.offsets[2] = 70;
    assert_refused( &scene, &good, "strand 2 ends before it begins" );
    frozen_scene_destroy( &scene );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( the_pipeline_is_its_stages_in_their_order ),
        cmocka_unit_test( aligning_before_deforming_is_not_the_method ),
        cmocka_unit_test( the_same_command_gives_the_same_bits_and_another_command_does_not ),
        cmocka_unit_test( strands_may_be_worked_off_in_any_order ),
        cmocka_unit_test( every_random_number_has_its_own_key ),
        cmocka_unit_test( each_strand_obeys_its_own_stiffness_and_intensity ),
        cmocka_unit_test( starting_from_the_previous_output_drifts_in_angle_but_not_in_length ),
        cmocka_unit_test( flat_hair_stays_flat_and_hair_in_space_does_not ),
        cmocka_unit_test( a_limit_of_depth_keeps_z_near_and_lengths_as_they_were ),
        cmocka_unit_test( with_a_limit_every_stage_leaves_depth_alone ),
        cmocka_unit_test( the_guard_keeps_pairs_apart_and_in_order_and_nothing_else_does ),
        cmocka_unit_test( degenerate_strands_come_out_finite_and_as_agreed ),
        cmocka_unit_test( stages_without_anything_to_do_change_nothing ),
        cmocka_unit_test( wrong_parameters_and_wrong_points_are_refused_by_name ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
