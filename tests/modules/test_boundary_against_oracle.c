// The engine's boundary points against those of the double-precision oracle, element by element and point by point:
// counts, parents, weights, positions, normals, and the elements that are resampled.
//
// The engine measures lengths in double precision from the same floats as the oracle, so counts are equal and not
// merely close: an edge's length over the spacing is the same double in both. A height or a line differs by some
// 1e-15, and no ratio of these meshes is that close to an integer. Only with hysteresis does the engine keep lengths
// as floats, where a count could differ within 1e-7 of an integer; none does here.
#include "boundary_duel_fixture.h"

#include "mesh.h"

// ---- tolerances ----

// A weight is a double rounded to a float. A position is three products and two sums in floats, of numbers no larger
// than the largest coordinate: a rounding for each of three weights, three products and two sums, half an epsilon
// each.
static double place_tolerance( const duel* d )
{
    double most = 0.0;
    for ( int i = 0; i < d->mesh.vertex_count; ++i )
    {
        const double3 x = d->x[i];
        most = fmax( most, fmax( fabs( x.x ), fmax( fabs( x.y ), fabs( x.z ) ) ) );
    }
    return 0.5 * 8.0 * (double)FLT_EPSILON * most * sqrt( 3.0 );
}

// The same for the sum of normals, whose own three are rounded too, and three more for the normalisation; all of that
// over the length of the sum, because a short sum is mostly rounding.
static double normal_tolerance( const duel* d, const boundary_oracle_point* p )
{
    const double3* n = d->oracle.vertex_normal;
    double3 sum = zero;
    for ( int k = 0; k < 3; ++k )
    {
        sum = double3_add( sum, double3_scale( p->weight[k], n[p->parent[k]] ) );
    }
    return 0.5 * 14.0 * (double)FLT_EPSILON * sqrt( 3.0 ) / fmax( double3_length( sum ), 1e-30 );
}

// ---- comparison ----

static int points_of_element( const boundary_oracle_memory* memory )
{
    int sum = 0;
    for ( int k = 0; k < memory->line_count; ++k )
    {
        sum += memory->points[k];
    }
    return sum;
}

static void assert_point( const duel* d, int p, double tolerance )
{
    const boundary_oracle_point* requested = d->oracle.points + p;
    const float *y = d->samples.xyzw + 4 * (size_t)p, *n = d->samples.normals + 4 * (size_t)p;
    int32_t element;
    memcpy( &element, y + 3, sizeof( element ) );
    assert_int_equal( element, requested->element );
    for ( int k = 0; k < 3; ++k )
    {
        assert_int_equal( d->samples.parents[p][k], 4 * requested->parent[k] );
        assert_close( (double)d->samples.weights[p][k], requested->weight[k], 0.5 * (double)FLT_EPSILON );
    }
    const double3 place = double3_make( (double)y[0], (double)y[1], (double)y[2] );
    assert_close( double3_distance( place, requested->y ), 0.0, tolerance );
    const double3 normal = double3_make( (double)n[0], (double)n[1], (double)n[2] );
    assert_close( double3_distance( normal, requested->normal ), 0.0, normal_tolerance( d, requested ) );
    assert_true( n[3] == 0.0f && d->samples.parents[p][3] == 0 && d->samples.weights[p][3] == 0.0f );
}

static void assert_agree( const duel* d )
{
    const boundary_oracle_layer* o = &d->oracle;
    const double tolerance = place_tolerance( d );
    for ( int e = 0; e < o->element_count; ++e )
    {
        const int count = d->samples.begin[e + 1] - d->samples.begin[e];
        if ( count != points_of_element( o->memory + e ) )
        {
            fail_msg( "element %d has %d points, the oracle has %d", e, count, points_of_element( o->memory + e ) );
        }
    }
    assert_int_equal( d->samples.count, o->point_count );
    assert_int_equal( d->samples.edge_count, o->edge_point_count );
    assert_int_equal( d->samples.skipped_elements, o->skipped_elements );
    assert_false( d->samples.refused );
    for ( int p = 0; p < o->point_count; ++p )
    {
        assert_point( d, p, tolerance );
    }
}

static bool is_same_generator( const boundary_oracle_point* a, const boundary_oracle_point* b, bool even )
{
    return a->line == b->line && a->step == b->step &&
           ( !even || memcmp( a->weight, b->weight, sizeof( a->weight ) ) == 0 );
}

// Number of elements whose points differ from before: these must be resampled.
static int elements_with_other_points( const duel* d )
{
    const boundary_oracle_layer* o = &d->oracle;
    int p = 0, q = 0, changed = 0;
    for ( int e = 0; e < o->element_count; ++e )
    {
        const int first = p;
        bool same = true;
        for ( ; p < o->point_count && o->points[p].element == e; ++p, ++q )
        {
            same = same && q < d->before_count && d->before[q].element == e &&
                   is_same_generator( d->before + q, o->points + p, d->def.policy == WISP_SPACING_EVEN );
            q -= q < d->before_count && d->before[q].element == e ? 0 : 1;
        }
        same = same && !( q < d->before_count && d->before[q].element == e );
        same = same && ( p == first || d->memory_before[e].axis == o->memory[e].axis );
        while ( q < d->before_count && d->before[q].element == e )
        {
            ++q;
        }
        changed += same ? 0 : 1;
    }
    return changed;
}

// Counts without points may change unnoticed, so the oracle, which compares counts, may report case B more often.
static void assert_resampled( const duel* d )
{
    const int least = elements_with_other_points( d );
    if ( d->samples.changed_elements < least || d->samples.changed_elements > d->oracle.changed_elements )
    {
        fail_msg( "%d elements are resampled: %d have other points, %d other counts", d->samples.changed_elements,
                  least, d->oracle.changed_elements );
    }
}

// ---- meshes ----

static balloon_mesh torus( void )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_torus( &mesh, 24, 13, 1.0, 0.4 ) );
    return mesh;
}

static balloon_mesh bunny( void )
{
    SCOPED( wisp_mesh_release ) wisp_mesh read = { 0 };
    wisp_error error = { 0 };
    assert_ok( wisp_mesh_read( WISP_SOURCE_ROOT "/data/bunny.obj", &read, &error ), error );
    SCOPED( free_local ) double3* points = checked_calloc( (size_t)read.vertex_count, sizeof( double3 ) );
    for ( int i = 0; i < read.vertex_count; ++i )
    {
        points[i] = double3_make( (double)read.points[i].x, (double)read.points[i].y, (double)read.points[i].z );
    }
    return mesh_of( points, read.vertex_count, read.triangles, read.triangle_count );
}

enum
{
    SHEET = 21, // vertices a side
};

// Open, with a slit in it, placed around a body, its vertices without any pattern.
static balloon_mesh garment( void )
{
    double3 points[SHEET * SHEET];
    int triangles[6 * ( SHEET - 1 ) * ( SHEET - 1 )], count = 0;
    for ( int n = 0; n < SHEET * SHEET; ++n )
    {
        const int i = n % SHEET, j = n / SHEET;
        const double s = 0.25 * i + random_between( n, 0, -0.09, 0.09 ),
                     t = 0.1 * j + random_between( n, 1, -0.04, 0.04 );
        points[n] = double3_make( ( 0.4 + 0.1 * t ) * cos( s ), -t, ( 0.4 + 0.1 * t ) * sin( s ) );
        const bool slit = i == SHEET / 2 && j > SHEET / 2;
        if ( i + 1 < SHEET && j + 1 < SHEET && !slit )
        {
            const int cell[6] = { n, n + 1, n + SHEET, n + SHEET, n + 1, n + SHEET + 1 };
            memcpy( triangles + 6 * count++, cell, sizeof( cell ) );
        }
    }
    return mesh_of( points, SHEET * SHEET, triangles, 2 * count );
}

// A sheet with coincident and collinear vertices: sides without length, triangles without area.
static balloon_mesh with_degenerate_triangles( void )
{
    balloon_mesh mesh = garment();
    for ( int n = 0; n < mesh.vertex_count; ++n )
    {
        double3* x = mesh.positions + n;
        *x = double3_make( 0.1 * ( n % SHEET ) + 0.003 * ( n % 7 ), 0.1 * ( n / SHEET ) + 0.004 * ( n % 5 ), 0.0 );
        x->x = n / SHEET == 8 ? 0.75 : x->x; // a whole row in one column, and the next one
        x->x = n / SHEET == 9 ? 0.75 : x->x;
        *x = n % SHEET == 5 && n > 0 ? mesh.positions[n - 1] : *x;
    }
    return mesh;
}

typedef struct named_mesh
{
    const char* name;
    balloon_mesh ( *make )( void );
    double spacing; // exactly a float, and no fraction of any regular side
} named_mesh;

static const named_mesh MESHES[] = {
    { "reference sphere", reference_sphere, 0.0703125 },
    { "torus", torus, 0.0322265625 },
    { "bunny", bunny, 0.0 }, // in its own units: see spacing_of()
    { "garment", garment, 0.0283203125 },
    { "degenerate", with_degenerate_triangles, 0.0126953125 },
};

// A fifth of the mean edge.
static double spacing_of( const named_mesh* named, const balloon_mesh* mesh )
{
    if ( named->spacing > 0.0 )
    {
        return named->spacing;
    }
    double sum = 0.0;
    for ( int n = 0; n < 3 * mesh->triangle_count; ++n )
    {
        const int *v = mesh->triangles + n - n % 3, k = n % 3;
        sum += double3_distance( mesh->positions[v[k]], mesh->positions[v[( k + 1 ) % 3]] );
    }
    return (double)(float)( 0.2 * sum / ( 3 * mesh->triangle_count ) );
}

// Swells and shrinks by a hundredth, every vertex with its own phase.
static void pulsate( double3* x, const balloon_mesh* mesh, int frame )
{
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        const double factor = 1.0 + 0.01 * sin( 0.3 * frame + 0.01 * i );
        x[i] = double3_scale( factor, mesh->positions[i] );
    }
}

// ---- tests ----

TEST( every_point_of_every_mesh_is_where_the_oracle_has_it )
{
    for ( int n = 0; n < WISP_COUNT( MESHES ); ++n )
    {
        SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = MESHES[n].make();
        for ( int c = 0; c < 6; ++c )
        {
            const duel_def def = { .spacing = spacing_of( MESHES + n, &mesh ),
                                   .policy = (wisp_spacing)( c % 2 ),
                                   .rounding = (wisp_rounding)( c / 2 % 3 ) };
            duel* d = duel_open( &mesh, &def );
            duel_update( d, mesh.positions );
            assert_true( d->oracle.edge_point_count > 100 && inner_points( &d->oracle ) > 100 );
            assert_agree( d );
            assert_int_equal( d->samples.changed_elements, d->oracle.element_count );
            duel_update( d, mesh.positions );
            assert_int_equal( d->samples.changed_elements, 0 );
            if ( c == 0 )
            {
                print_message( "%s: %d on edges, %d inside\n", MESHES[n].name, d->samples.edge_count,
                               d->samples.count - d->samples.edge_count );
            }
            duel_close( d );
        }
    }
}

TEST( table_b5_holds_for_the_engine )
{
    const float spacing[4] = { 0.2f, 0.1f, 0.05f, 0.025f };
    const int requested[2][4][2] = { { { 930, 0 }, { 5160, 300 }, { 14730, 11640 }, { 32670, 79320 } },
                                     { { 3360, 0 }, { 7710, 3480 }, { 17340, 21360 }, { 35280, 103560 } } };
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    for ( int n = 0; n < 8; ++n )
    {
        const duel_def def = { .spacing = (double)spacing[n % 4], .policy = (wisp_spacing)( n / 4 ) };
        duel* d = duel_open( &mesh, &def );
        duel_update( d, mesh.positions );
        assert_int_equal( d->samples.edge_count, requested[n / 4][n % 4][0] );
        assert_int_equal( d->samples.count - d->samples.edge_count, requested[n / 4][n % 4][1] );
        duel_close( d );
    }
}

TEST( points_follow_a_pulsation_as_those_of_the_oracle )
{
    for ( int n = 0; n < WISP_COUNT( MESHES ); ++n )
    {
        SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = MESHES[n].make();
        SCOPED( free_local ) double3* x = checked_calloc( (size_t)mesh.vertex_count, sizeof( double3 ) );
        for ( int c = 0; c < 6; ++c )
        {
            const duel_def def = { .spacing = spacing_of( MESHES + n, &mesh ),
                                   .policy = (wisp_spacing)( c % 2 ),
                                   .rounding = (wisp_rounding)( c % 3 ),
                                   .hysteresis = c >= 3 ? 0.125 : 0.0 };
            duel* d = duel_open( &mesh, &def );
            int changed = 0;
            for ( int frame = 0; frame < 20; ++frame )
            {
                pulsate( x, &mesh, frame );
                duel_update( d, x );
                assert_agree( d );
                assert_resampled( d );
                changed += frame > 0 ? d->samples.changed_elements : 0;
            }
            assert_true( changed > 0 && changed < 19 * d->oracle.element_count );
            duel_close( d );
        }
    }
}

// Bits of a row of four, without the padding.
static void assert_same_rows( const void* a, const void* b, int count )
{
    assert_memory_equal( a, b, (size_t)count * 4 * sizeof( float ) );
}

static void assert_same_bits( const wisp_samples* a, const wisp_samples* b )
{
    assert_int_equal( a->count, b->count );
    assert_int_equal( a->edge_count, b->edge_count );
    assert_same_rows( a->xyzw, b->xyzw, a->count );
    assert_same_rows( a->normals, b->normals, a->count );
    assert_same_rows( a->parents, b->parents, a->count );
    assert_same_rows( a->weights, b->weights, a->count );
}

TEST( what_followed_in_place_has_the_bits_of_what_is_resampled )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    double3 x[872];
    for ( int c = 0; c < 6; ++c )
    {
        const duel_def def = { .spacing = 0.0703125,
                               .policy = (wisp_spacing)( c % 2 ),
                               .rounding = (wisp_rounding)( c / 2 % 3 ),
                               .workers = 1 + c % 3 };
        const duel_def other = {
            .spacing = def.spacing, .policy = def.policy, .rounding = def.rounding, .workers = 8, .isa = "baseline"
        };
        duel* followed = duel_open( &mesh, &def );
        for ( int frame = 0; frame < 8; ++frame )
        {
            pulsate( x, &mesh, 3 * frame );
            duel_update( followed, x );
            duel* resampled = duel_open( &mesh, &other );
            duel_update( resampled, x );
            assert_same_bits( &followed->samples, &resampled->samples );
            duel_close( resampled );
        }
        duel_close( followed );
    }
}

// The number of lines changes and no number of points on them does: all points move.
TEST( a_line_more_without_points_moves_the_lines_below_it )
{
    SCOPED( balloon_mesh_destroy )
    balloon_mesh mesh =
        one_triangle( double3_make( 0, 0, 0 ), double3_make( 3.25, 0, 0 ), double3_make( 1.5, 3.875, 0 ) );
    for ( int c = 0; c < 2; ++c )
    {
        const duel_def def = { .spacing = 1.0, .hysteresis = c == 0 ? 0.0 : 0.0625 };
        duel* d = duel_open( &mesh, &def );
        for ( int frame = 0; frame < 6; ++frame )
        {
            // 3 lines of heights, then 4, then 3 again: one point on the first, none above
            const double3 x[3] = { mesh.positions[0], mesh.positions[1],
                                   double3_make( 1.5, frame / 2 % 2 == 0 ? 3.875 : 4.125, 0 ) };
            duel_update( d, x );
            assert_int_equal( inner_points( &d->oracle ), 1 );
            assert_agree( d );
            assert_resampled( d );
        }
        duel_close( d );
    }
}

TEST( a_corner_that_is_not_finite_takes_its_elements_away_and_gives_them_back )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    for ( int c = 0; c < 4; ++c )
    {
        const duel_def def = { .spacing = 0.0703125, .policy = (wisp_spacing)( c % 2 ), .hysteresis = c / 2 * 0.125 };
        duel* d = duel_open( &mesh, &def );
        duel_update( d, mesh.positions );
        const double3 place = mesh.positions[300];
        mesh.positions[300].z = c % 2 == 0 ? (double)NAN : (double)INFINITY;
        duel_update( d, mesh.positions );
        assert_int_equal( d->samples.skipped_elements, 12 );
        for ( int e = 0; e < d->oracle.element_count; ++e )
        {
            assert_int_equal( d->samples.begin[e + 1] - d->samples.begin[e],
                              points_of_element( d->oracle.memory + e ) );
        }
        for ( int p = 0; p < d->samples.count; ++p )
        {
            assert_true( isfinite( d->samples.xyzw[4 * p] ) && isfinite( d->samples.normals[4 * p] ) );
        }
        mesh.positions[300] = place;
        duel_update( d, mesh.positions );
        assert_agree( d );
        assert_resampled( d );
        duel_close( d );
    }
}

// With barycentric normals. Along lines the engine's normals also keep the weights of the last step, and differ by
// some 1e-6 rad here.
TEST( a_refused_layer_follows_with_the_weights_it_had )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    double3 x[872];
    for ( int c = 0; c < 2; ++c )
    {
        const duel_def def = { .spacing = 0.0703125, .policy = (wisp_spacing)c };
        duel* d = duel_open( &mesh, &def );
        duel_update( d, mesh.positions );
        const int points = d->samples.count;
        // the oracle rejects by its estimate, the engine by its count
        d->oracle.options.cap = 1.0;
        d->args.limit = points - 1;
        pulsate( x, &mesh, 5 );
        duel_update( d, x );
        assert_true( d->oracle.refused && d->samples.refused && d->samples.requested > points - 1 );
        assert_int_equal( d->samples.count, points );
        assert_int_equal( d->samples.changed_elements, 0 );
        for ( int p = 0; p < points; ++p )
        {
            assert_point( d, p, place_tolerance( d ) );
        }
        // a number of points that no memory has takes none
        const int64_t bytes = atomic_load( &d->host.bytes );
        for ( int n = 0; n < 2; ++n )
        {
            d->args.spacing = n == 0 ? 1e-6f : 1e-20f;
            duel_update( d, x );
            assert_true( d->samples.refused && d->samples.count == points && atomic_load( &d->host.bytes ) == bytes );
        }
        d->args.spacing = (float)def.spacing;
        // with enough room again it is sampled as before
        d->oracle.options.cap = 1e9;
        d->args.limit = 4000000;
        duel_update( d, x );
        assert_agree( d );
        duel_close( d );
    }
}

TEST( normals_that_cancel_are_those_of_the_faces_or_of_the_last_step )
{
    // both sides of one sheet: vertices and edges have no normal, faces have; then a triangle loses its area
    const double3 points[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1.25, 0 } };
    const int triangles[] = { 0, 1, 2, 0, 2, 1 };
    const duel_def def = { .spacing = 0.1875 };
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = mesh_of( points, 3, triangles, 2 );
    duel* d = duel_open( &mesh, &def );
    duel_update( d, mesh.positions );
    assert_int_equal( d->oracle.fallback_normals, d->oracle.point_count );
    assert_true( inner_points( &d->oracle ) > 10 );
    assert_agree( d );
    duel_close( d );
    balloon_mesh_destroy( &mesh );

    mesh = one_triangle( points[0], points[1], points[2] );
    d = duel_open( &mesh, &def );
    duel_update( d, mesh.positions );
    const double3 flat[3] = { points[0], points[1], points[0] };
    duel_update( d, flat );
    // the side of unchanged length keeps its normals, the other has none to keep
    assert_true( d->oracle.point_count > 4 && d->oracle.fallback_normals == d->oracle.point_count );
    assert_agree( d );
    assert_true( d->oracle.points[0].normal.z == 1.0 );
    duel_close( d );
}

// ---- counts by hand ----

TEST( edges_have_the_counts_of_their_lengths )
{
    // of half a metre: 0.3, 1, 1.5, 2 and 3.7 spacings (section 2.1), all of them floats
    static const double lengths[] = { 0.15625, 0.5, 0.75, 1.0, 1.84375 };
    static const struct
    {
        duel_def def;
        int points[WISP_COUNT( lengths )];
    } cases[] = { { { .spacing = 0.5 }, { 0, 0, 0, 1, 2 } },
                  { { .spacing = 0.5, .policy = WISP_SPACING_EXACT }, { 0, 0, 1, 1, 3 } },
                  { { .spacing = 0.5, .rounding = WISP_ROUND_UP }, { 0, 0, 1, 1, 3 } },
                  { { .spacing = 0.5, .rounding = WISP_ROUND_NEAREST }, { 0, 0, 1, 1, 3 } } };
    for ( int i = 0; i < WISP_COUNT( cases ) * WISP_COUNT( lengths ); ++i )
    {
        const double3 points[3] = { zero, double3_make( lengths[i / 4], 0, 0 ), double3_make( 0, 0.0009765625, 0 ) };
        SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = one_triangle( points[0], points[1], points[2] );
        duel* d = duel_open( &mesh, &cases[i % 4].def );
        duel_update( d, mesh.positions );
        assert_agree( d );
        assert_int_equal( d->args.edge_points[0], cases[i % 4].points[i / 4] );
        duel_close( d );
    }
}

TEST( hysteresis_keeps_counts_until_lengths_are_well_beyond )
{
    static const double lengths[] = { 2.125, 1.875, 1.84375, 1.75, 2.0, 2.125, 2.15625, 2.25, 1.875 };
    static const int expected[] = { 1, 1, 1, 0, 0, 0, 0, 1, 1 };
    const duel_def def = { .spacing = 1.0, .hysteresis = 0.1875 };
    SCOPED( balloon_mesh_destroy )
    balloon_mesh mesh = one_triangle( zero, double3_make( 2.125, 0, 0 ), double3_make( 1, 3, 0 ) );
    duel* d = duel_open( &mesh, &def );
    for ( int i = 0; i < WISP_COUNT( lengths ); ++i )
    {
        const double3 x[3] = { zero, double3_make( lengths[i], 0, 0 ), double3_make( 0.5 * lengths[i], 3, 0 ) };
        duel_update( d, x );
        assert_agree( d );
        assert_int_equal( d->args.edge_points[0], expected[i] );
    }
    duel_close( d );
}

TEST( the_lowest_of_equally_short_sides_is_the_axis )
{
    // legs of a right triangle, rotated through its corners: lines at 1/4, 1/2 and 3/4 of the height, of 3, 2 and 1 spacings
    static const int axis[3] = { 0, 1, 0 };
    const double3 corner[3] = { zero, double3_make( 1, 0, 0 ), double3_make( 0, 1, 0 ) };
    for ( int i = 0; i < 3; ++i )
    {
        SCOPED( balloon_mesh_destroy )
        balloon_mesh mesh = one_triangle( corner[i], corner[( i + 1 ) % 3], corner[( i + 2 ) % 3] );
        duel* d = duel_open( &mesh, &( duel_def ){ .spacing = 0.25 } );
        duel_update( d, mesh.positions );
        assert_agree( d );
        assert_true( d->args.triangle_axis[0] == axis[i] && d->args.triangle_points[0] == 2 + 1 );
        duel_close( d );
    }
}

TEST( triangles_without_area_and_edges_without_length_have_no_points )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = with_degenerate_triangles();
    duel* d = duel_open( &mesh, &( duel_def ){ .spacing = 0.0126953125 } );
    duel_update( d, mesh.positions );
    int without = 0;
    for ( int t = 0; t < mesh.triangle_count; ++t )
    {
        const int* v = mesh.triangles + 3 * t;
        const double3 a = double3_sub( d->x[v[1]], d->x[v[0]] ), b = double3_sub( d->x[v[2]], d->x[v[0]] );
        const bool is_flat = double3_length( double3_cross( a, b ) ) == 0.0;
        assert_true( is_flat == false || d->args.triangle_points[t] == 0 );
        without += is_flat;
    }
    assert_true( without > 20 );
    for ( int e = 0; e < d->args.edge_count; ++e )
    {
        const double length = double3_distance( d->x[d->edges[2 * e]], d->x[d->edges[2 * e + 1]] );
        assert_true( length > 0.0 || d->args.edge_points[e] == 0 );
    }
    duel_close( d );
}

// ---- memory ----

TEST( a_state_put_back_brings_its_points_back )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    double3 x[872];
    const duel_def def = { .spacing = 0.0703125, .hysteresis = 0.375 };
    duel *through = duel_open( &mesh, &def ), *back = duel_open( &mesh, &def );
    const size_t edges = (size_t)through->args.edge_count * 4, triangles = (size_t)mesh.triangle_count * 4;
    for ( int frame = 0; frame < 20; ++frame )
    {
        pulsate( x, &mesh, frame );
        duel_update( through, x );
    }
    duel_update( back, mesh.positions ); // used memory of another layer
    memcpy( back->args.edge_length, through->args.edge_length, edges );
    memcpy( back->args.edge_points, through->args.edge_points, edges );
    memcpy( back->args.triangle_extent, through->args.triangle_extent, 2 * triangles );
    memcpy( back->args.triangle_axis, through->args.triangle_axis, triangles );
    memcpy( back->args.triangle_points, through->args.triangle_points, triangles );
    for ( int frame = 19; frame < 30; ++frame )
    {
        pulsate( x, &mesh, frame );
        duel_update( through, x );
        duel_update( back, x );
        assert_same_bits( &through->samples, &back->samples );
        assert_memory_equal( through->args.edge_length, back->args.edge_length, edges );
        assert_memory_equal( through->args.triangle_extent, back->args.triangle_extent, 2 * triangles );
        assert_memory_equal( through->args.edge_points, back->args.edge_points, edges );
    }
    duel_close( through );
    duel_close( back );
}

TEST( without_memory_points_are_those_of_the_last_call )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    duel* d = duel_open( &mesh, &( duel_def ){ .spacing = 0.0703125, .workers = 1 } );
    for ( int n = 1; n <= 2; ++n )
    {
        test_host_refuse( &d->host, n, true );
        assert_int_equal( duel_try( d, mesh.positions ), WISP_NO_MEMORY );
    }
    test_host_refuse( &d->host, 0, false );
    duel_update( d, mesh.positions );
    const int count = d->samples.count, points = d->args.edge_points[3];
    d->args.spacing = 0.015f;
    test_host_refuse( &d->host, 1, true );
    assert_int_equal( duel_try( d, mesh.positions ), WISP_NO_MEMORY );
    assert_true( d->samples.count == count && d->args.edge_points[3] == points );
    test_host_refuse( &d->host, 0, false );
    duel_update( d, mesh.positions );
    assert_true( d->samples.count > 4 * count );
    duel_close( d );
}

TEST( a_layer_without_normals_has_places_alone )
{
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = reference_sphere();
    const duel_def def = { .spacing = 0.0703125 };
    duel *with = duel_open( &mesh, &def ), *without = duel_open( &mesh, &def );
    without->args.normal = NULL;
    duel_update( with, mesh.positions );
    duel_update( without, mesh.positions );
    assert_null( without->samples.normals );
    assert_same_rows( with->samples.xyzw, without->samples.xyzw, with->samples.count );
    without->args.normal = without->normal;
    duel_update( without, mesh.positions );
    assert_same_bits( &with->samples, &without->samples );
    duel_close( with );
    duel_close( without );
}
