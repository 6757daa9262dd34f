// The engine's local spacing against that of the double-precision oracle: one value per edge and per triangle, and the points
// that follow from them. The oracle gets positions and rest positions alone; its normals, lengths and spacings are its own.
#include "boundary_fixture.h"
#include "boundary_oracle_fixture.h"

enum
{
    LEVEL = 3, // of the ball: 258 vertices, 768 edges, 512 triangles
    EDGES = 768,
    TRIANGLES = 512,
    SPACING_COLUMN = 0, // of boundary.edges and boundary.triangles
};

static const double UNIT = 0x1p-24; // the rounding of a float

typedef struct spacing_case
{
    const char* name;
    float curvature_gain, strain_gain;
    float eye_angle; // rad, 0: not by distance
    float min_spacing, max_spacing;
} spacing_case;

// The ball hangs by two vertices and sags, so strains are up to a third and curvature differs from place to
// place. Limits of the first four are out of reach.
static const spacing_case CASES[] = {
    { "curvature", 10.0f, 0.0f, 0.0f, 1e-3f, 10.0f },
    { "finer by strain", 0.0f, 40.0f, 0.0f, 1e-3f, 10.0f },
    { "coarser by strain", 0.0f, -40.0f, 0.0f, 1e-3f, 10.0f },
    { "distance", 0.0f, 0.0f, 0.01f, 1e-3f, 10.0f },
    { "all, with limits", 4.0f, 20.0f, 0.01f, 0.018f, 0.028f },
};

static const wisp_vec3 EYE = { 2.0f, 1.0f, 4.0f };

static wisp_boundary_def def_of( const spacing_case* c )
{
    wisp_boundary_def def = ball_layer( 0.05f );
    def.curvature_gain = c->curvature_gain;
    def.strain_gain = c->strain_gain;
    def.min_spacing = c->min_spacing;
    def.max_spacing = c->max_spacing;
    def.eye = EYE;
    def.eye_angle = c->eye_angle;
    return def;
}

static boundary_oracle_criteria criteria_of( const spacing_case* c )
{
    return ( boundary_oracle_criteria ){
        .least = (double)c->min_spacing,
        .most = (double)c->max_spacing,
        .curvature_gain = (double)c->curvature_gain,
        .strain_gain = (double)c->strain_gain,
        .eye = double3_widen( EYE ),
        .eye_angle = (double)c->eye_angle,
    };
}

// Relative. A spacing is a quotient or a product of a few floats. An angle between normals comes from two vertex normals, each a
// sum of six cross products with a root and a quotient; a strain from two lengths of five operations. Their errors are absolute
// and are multiplied by the gain.
static double tolerance_of( const spacing_case* c )
{
    return UNIT * ( 8.0 + 16.0 * (double)c->curvature_gain + 8.0 * fabs( (double)c->strain_gain ) );
}

// The ball as the oracle has it: the engine's positions, in the user's order.
static balloon_mesh mesh_now( ball_world* b, const wisp_boundary_view* view )
{
    double3 points[258] = { { 0 } };
    const float* x = wisp_world_column( b->world, b->ball, WISP_PARTICLE_POSITION, 0 );
    for ( int slot = 0; slot < b->mesh.vertex_count; ++slot )
    {
        points[view->slot_vertex[slot]] = double3_from( x + 4 * (size_t)slot );
    }
    return mesh_of( points, b->mesh.vertex_count, b->mesh.triangles, b->mesh.triangle_count );
}

typedef struct spacings
{
    double edge[EDGES], triangle[TRIANGLES];
} spacings;

static void find_spacings( const balloon_mesh* mesh, const wisp_vec3* rest, const boundary_oracle_layer* layer,
                           const boundary_oracle_criteria* criteria, spacings* out )
{
    for ( int e = 0; e < EDGES; ++e )
    {
        const int a = layer->topology.edges[e].a, b = layer->topology.edges[e].b;
        const double length = double3_distance( double3_widen( rest[a] ), double3_widen( rest[b] ) );
        out->edge[e] = boundary_oracle_local_spacing( criteria, (double)0.05f, mesh->positions[a], mesh->positions[b],
                                                      layer->vertex_normal[a], layer->vertex_normal[b], length );
    }
    for ( int t = 0; t < TRIANGLES; ++t )
    {
        const int* e = layer->topology.triangle_edge + 3 * t;
        out->triangle[t] = boundary_oracle_triangle_spacing(
            ( const double[3] ){ out->edge[e[0]], out->edge[e[1]], out->edge[e[2]] } );
    }
}

static const float* spacing_column( ball_world* b, const char* component )
{
    const wisp_component found = wisp_world_find_component( b->world, component );
    return wisp_world_column( b->world, b->ball, found, SPACING_COLUMN );
}

static void assert_spacings( const spacing_case* c, const char* element, const float* found, const double* expected,
                             int count )
{
    for ( int i = 0; i < count; ++i )
    {
        const double off = (double)found[i] / expected[i] - 1.0;
        if ( !( fabs( off ) <= tolerance_of( c ) ) )
        {
            fail_msg( "%s: spacing of %s %d is %.9g m, the oracle has %.9g m: relative error %.2g, allowed %.2g",
                      c->name, element, i, (double)found[i], expected[i], off, tolerance_of( c ) );
        }
    }
}

// No ratio of this ball is so close to an integer that the tolerance of the spacing decides on a count.
static void assert_counts( const spacing_case* c, const wisp_samples* found, const boundary_oracle_layer* layer )
{
    int points[EDGES + TRIANGLES] = { 0 };
    for ( int p = 0; p < layer->point_count; ++p )
    {
        points[layer->points[p].element] += 1;
    }
    for ( int e = 0; e < EDGES + TRIANGLES; ++e )
    {
        if ( found->begin[e + 1] - found->begin[e] != points[e] )
        {
            fail_msg( "%s: element %d has %d points, the oracle has %d", c->name, e,
                      found->begin[e + 1] - found->begin[e], points[e] );
        }
    }
}

// How many edges the criterion in question, the lower and the upper limit decide on.
static void assert_effective( const spacing_case* c, const spacings* s )
{
    int at_min = 0, at_max = 0;
    double least = INFINITY, most = 0.0;
    for ( int e = 0; e < EDGES; ++e )
    {
        at_min += s->edge[e] == (double)c->min_spacing ? 1 : 0;
        at_max += s->edge[e] == (double)c->max_spacing ? 1 : 0;
        least = fmin( least, s->edge[e] );
        most = fmax( most, s->edge[e] );
    }
    const bool limited = c->max_spacing < 1.0f;
    print_message( "%s: %.4f .. %.4f m, %d edges at the lower limit, %d at the upper\n", c->name, least, most, at_min,
                   at_max );
    assert_true( limited ? at_min > 20 && at_max > 20 && at_min + at_max < EDGES - 100 : at_min + at_max == 0 );
    assert_true( most > 1.1 * least );
}

static void compare( const spacing_case* c )
{
    SCOPED( ball_close ) ball_world* b = ball_open( LEVEL, 2, NULL );
    const wisp_boundary_def def = def_of( c );
    set_layer( b, b->ball, &def );
    ball_steps( b, 12 );
    const wisp_boundary_view view = layer_of( b, b->ball );
    assert_int_equal( view.edge_count, EDGES );
    SCOPED( balloon_mesh_destroy ) balloon_mesh mesh = mesh_now( b, &view );
    const boundary_oracle_options options = { .spacing = (double)0.05f, .cap = 1e6 };
    SCOPED( boundary_oracle_destroy ) boundary_oracle_layer layer = layer_on( &mesh, &options );
    const boundary_oracle_criteria criteria = criteria_of( c );
    static spacings expected;
    find_spacings( &mesh, b->mesh.points, &layer, &criteria, &expected );
    assert_effective( c, &expected );
    assert_spacings( c, "edge", spacing_column( b, "boundary.edges" ), expected.edge, EDGES );
    assert_spacings( c, "triangle", spacing_column( b, "boundary.triangles" ), expected.triangle, TRIANGLES );

    layer.options.edge_spacing = expected.edge;
    layer.options.triangle_spacing = expected.triangle;
    must_update( &layer, mesh.positions );
    assert_true( layer.edge_point_count > EDGES && inner_points( &layer ) > TRIANGLES / 4 );
    assert_counts( c, view.samples, &layer );
}

TEST( spacing_by_curvature_is_that_of_the_oracle )
{
    compare( CASES );
}

TEST( spacing_by_strain_is_that_of_the_oracle )
{
    compare( CASES + 1 );
    compare( CASES + 2 );
}

TEST( spacing_by_distance_is_that_of_the_oracle )
{
    compare( CASES + 3 );
}

TEST( the_smallest_of_all_criteria_within_its_limits_is_that_of_the_oracle )
{
    compare( CASES + 4 );
}
