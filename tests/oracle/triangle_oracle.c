// The arc, the forces of links and their energies: Noh and Jung, Eq. 2-15.
#include "triangle_oracle.h"

#include <stdlib.h>
#include <string.h>

// ---- links ----

// The links of a mesh, their weights, and the memory of a cloth: Noh and Jung, Eq. 1.

triangle_oracle_params triangle_oracle_default_params( void )
{
    return ( triangle_oracle_params ){
        .stretch_stiffness = 200.0,
        .bend_stiffness = 1e-6,
        .bend_rigidity = 5e-6,
        .damping = 0.02,
        .gravity = { 0.0, -9.81, 0.0 },
        .newton_iterations = 1,
        .tolerance = 1e-12,
        .speculative = true,
        .release_hysteresis = 1e-4,
    };
}

// ---- links ----

static double area( const triangle_oracle_def* def, int triangle )
{
    const int* t = def->triangles + 3 * triangle;
    const double3 a = def->points[t[0]];
    const double3 normal = double3_cross( double3_sub( def->points[t[1]], a ), double3_sub( def->points[t[2]], a ) );
    return 0.5 * double3_length( normal );
}

void triangle_oracle_lump( const triangle_oracle_def* def, double density, double* masses )
{
    double whole = 0.0;
    for ( int i = 0; i < def->count; ++i )
    {
        masses[i] = 0.0;
    }
    for ( int t = 0; t < def->triangle_count; ++t )
    {
        const double mass = density * area( def, t );
        whole += mass;
        for ( int corner = 0; corner < 3; ++corner )
        {
            masses[def->triangles[3 * t + corner]] += mass / 3.0;
        }
    }
    for ( int i = 0; i < def->count; ++i )
    {
        masses[i] = fmax( masses[i], 1e-6 * whole / def->count );
    }
}

// A pair of vertices with its mesh elements: an edge and its triangle, or a diagonal.
typedef struct pair
{
    int i, j, opposite;
    double area;
} pair;

static pair pair_of( int a, int b, int opposite, double its_area )
{
    return ( pair ){ a < b ? a : b, a < b ? b : a, opposite, its_area };
}

static int compare_pairs( const void* a, const void* b )
{
    const pair *p = a, *q = b;
    const int difference[3] = { p->i - q->i, p->j - q->j, p->opposite - q->opposite };
    const int n = difference[0] != 0 ? 0 : difference[1] != 0 ? 1 : 2;
    return ( difference[n] > 0 ) - ( difference[n] < 0 );
}

static bool is_same( pair p, pair q )
{
    return p.i == q.i && p.j == q.j;
}

// Merge equal pairs; the areas of all of them are added.
static int merge( pair* pairs, int count )
{
    int kept = 0;
    qsort( pairs, (size_t)count, sizeof( pair ), compare_pairs );
    for ( int n = 0; n < count; ++n )
    {
        if ( kept > 0 && is_same( pairs[kept - 1], pairs[n] ) )
        {
            pairs[kept - 1].area += pairs[n].area;
        }
        else
        {
            pairs[kept++] = pairs[n];
        }
    }
    return kept;
}

// Every edge of every triangle, sorted: triangles at the same edge are consecutive.
static pair* edges_of( const triangle_oracle_def* def )
{
    pair* edges = calloc( (size_t)( 3 * def->triangle_count + 1 ), sizeof( pair ) );
    for ( int n = 0; n < 3 * def->triangle_count; ++n )
    {
        const int *t = def->triangles + n / 3 * 3, c = n % 3;
        edges[n] = pair_of( t[c], t[( c + 1 ) % 3], t[( c + 2 ) % 3], area( def, n / 3 ) );
    }
    qsort( edges, (size_t)( 3 * def->triangle_count ), sizeof( pair ), compare_pairs );
    return edges;
}

// The opposite vertices of every two triangles at an edge. The same vertex on both sides gives no pair.
static pair* diagonals_of( const triangle_oracle_def* def, const pair* edges, int* count )
{
    const int edge_count = 3 * def->triangle_count;
    pair* diagonals = NULL;
    for ( int pass = 0; pass < 2; ++pass )
    {
        *count = 0;
        for ( int a = 0; a < edge_count; ++a )
        {
            for ( int b = a + 1; b < edge_count && is_same( edges[a], edges[b] ); ++b )
            {
                if ( edges[a].opposite != edges[b].opposite )
                {
                    if ( pass == 1 )
                    {
                        diagonals[*count] =
                            pair_of( edges[a].opposite, edges[b].opposite, 0, edges[a].area + edges[b].area );
                    }
                    ++*count;
                }
            }
        }
        if ( pass == 0 )
        {
            diagonals = calloc( (size_t)*count + 1, sizeof( pair ) );
        }
    }
    return diagonals;
}

static pair* pairs_by_hand( const int* vertices, int count )
{
    pair* pairs = calloc( (size_t)count + 1, sizeof( pair ) );
    for ( int n = 0; n < count; ++n )
    {
        pairs[n] = ( pair ){ vertices[2 * n], vertices[2 * n + 1], 0, 0.0 };
    }
    return pairs;
}

static triangle_oracle_link make_link( const triangle_oracle_params* p, pair of, bool bends, double length )
{
    const bool sheet = p->stiffness == TRIANGLE_ORACLE_STIFFNESS_MATERIAL;
    const double fraction = sheet ? of.area / ( length * length ) : 1.0;
    const double compression = p->compression_stiffness > 0.0 ? p->compression_stiffness : p->stretch_stiffness;
    const double bend = sheet ? p->bend_rigidity * of.area / length : p->bend_stiffness;
    return ( triangle_oracle_link ){
        .i = of.i,
        .j = of.j,
        .bends = bends,
        .area = of.area,
        .length = length,
        .stretch = bends ? 0.0 : fraction * p->stretch_stiffness,
        .bend = bends ? bend : 0.0,
        .ramp = bends ? fraction * compression : 0.0,
        .damping = fraction * p->damping,
        .scale = 1.0,
    };
}

static void add_links( triangle_oracle* cloth, const triangle_oracle_def* def, const pair* pairs, int count,
                       bool bends )
{
    for ( int n = 0; n < count; ++n )
    {
        const double length = double3_distance( def->points[pairs[n].i], def->points[pairs[n].j] );
        cloth->link[cloth->link_count++] = make_link( &cloth->params, pairs[n], bends, length );
    }
}

static void make_links( triangle_oracle* cloth, const triangle_oracle_def* def )
{
    const bool no_diagonals = def->bend_pairs != NULL || def->stretch_pairs != NULL;
    const int hand_count = def->bend_pairs == NULL ? 0 : def->bend_pair_count;
    int diagonal_count = 0;
    pair* edges = edges_of( def );
    pair* diagonals =
        no_diagonals ? pairs_by_hand( def->bend_pairs, hand_count ) : diagonals_of( def, edges, &diagonal_count );
    cloth->bend_count = no_diagonals ? hand_count : merge( diagonals, diagonal_count );
    cloth->stretch_count = merge( edges, 3 * def->triangle_count );
    if ( def->stretch_pairs != NULL )
    {
        free( edges );
        edges = pairs_by_hand( def->stretch_pairs, def->stretch_pair_count );
        cloth->stretch_count = def->stretch_pair_count;
    }
    const size_t link_count = (size_t)( cloth->stretch_count + cloth->bend_count );
    cloth->link = calloc( link_count + 1, sizeof( triangle_oracle_link ) );
    cloth->term = calloc( link_count + 1, sizeof( triangle_oracle_term ) );
    add_links( cloth, def, edges, cloth->stretch_count, false );
    add_links( cloth, def, diagonals, cloth->bend_count, true );
    free( edges );
    free( diagonals );
}

// ---- weights ----

// |N_i|: a neighbour is counted once, however many links lead to it.
static void count_neighbours( triangle_oracle* cloth )
{
    pair* pairs = calloc( (size_t)cloth->link_count + 1, sizeof( pair ) );
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        pairs[k] = pair_of( cloth->link[k].i, cloth->link[k].j, 0, 0.0 );
    }
    const int count = merge( pairs, cloth->link_count );
    for ( int n = 0; n < count; ++n )
    {
        ++cloth->neighbours[pairs[n].i];
        ++cloth->neighbours[pairs[n].j];
    }
    free( pairs );
}

// (1), changed by the switch.
static void weigh( triangle_oracle* cloth, const double* masses )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        cloth->max_neighbours = (int)fmax( cloth->max_neighbours, cloth->neighbours[i] );
    }
    for ( int i = 0; i < cloth->count; ++i )
    {
        const int n = cloth->neighbours[i];
        cloth->weight[i] = n > 0 ? (double)cloth->max_neighbours / n : 1.0;
        cloth->true_mass[i] = masses[i];
        const bool effective = cloth->params.weights == TRIANGLE_ORACLE_WEIGHTS_EFFECTIVE;
        cloth->mass[i] = effective ? masses[i] / cloth->weight[i] : masses[i];
    }
}

// ---- a material ----

static void make_plate( triangle_oracle* cloth )
{
    plate_oracle_destroy( &cloth->plate );
    cloth->plate =
        plate_oracle_create( cloth->rest, cloth->count, cloth->triangles, cloth->triangle_count, cloth->pinned );
}

// A material bends as a plate, and its edges bear pressure as arcs as wide as the triangles around them.
static void become_material( triangle_oracle* cloth, const triangle_oracle_def* def )
{
    const size_t edges = (size_t)cloth->stretch_count, corners = 3 * (size_t)def->triangle_count;
    cloth->link = realloc( cloth->link, ( 2 * edges + 1 ) * sizeof( triangle_oracle_link ) );
    cloth->term = realloc( cloth->term, ( 2 * edges + 1 ) * sizeof( triangle_oracle_term ) );
    for ( size_t k = 0; k < edges; ++k )
    {
        const triangle_oracle_link* edge = cloth->link + k;
        const pair of = { edge->i, edge->j, 0, edge->area };
        cloth->link[edges + k] = make_link( &cloth->params, of, true, edge->length );
        cloth->link[edges + k].scale = edge->scale;
    }
    cloth->bend_count = cloth->stretch_count;
    cloth->link_count = 2 * cloth->stretch_count;
    cloth->rest = calloc( (size_t)cloth->count, sizeof( double3 ) );
    cloth->triangles = calloc( corners + 1, sizeof( int ) );
    cloth->triangle_count = def->triangle_count;
    memcpy( cloth->rest, def->points, (size_t)cloth->count * sizeof( double3 ) );
    memcpy( cloth->triangles, def->triangles, corners * sizeof( int ) );
    make_plate( cloth );
}

// ---- the cloth ----

static void take_memory( triangle_oracle* cloth )
{
    const size_t n = (size_t)cloth->count;
    cloth->neighbours = calloc( n, sizeof( int ) );
    cloth->pinned = calloc( n, sizeof( bool ) );
    double** numbers[] = { &cloth->weight, &cloth->true_mass, &cloth->mass };
    for ( size_t k = 0; k < sizeof( numbers ) / sizeof( numbers[0] ); ++k )
    {
        *numbers[k] = calloc( n, sizeof( double ) );
    }
    double3** vectors[] = { &cloth->x,          &cloth->v,    &cloth->x_before, &cloth->v_before, &cloth->target,
                            &cloth->prescribed, &cloth->push, &cloth->change,   &cloth->impulse };
    for ( size_t k = 0; k < sizeof( vectors ) / sizeof( vectors[0] ); ++k )
    {
        *vectors[k] = calloc( n, sizeof( double3 ) );
    }
    cloth->freedom = calloc( n, sizeof( triangle_oracle_matrix ) );
    cloth->contact = calloc( n, sizeof( triangle_oracle_contact ) );
}

triangle_oracle triangle_oracle_create( const triangle_oracle_def* def, const triangle_oracle_params* params )
{
    triangle_oracle cloth = { .params = *params, .count = def->count };
    take_memory( &cloth );
    make_links( &cloth, def );
    count_neighbours( &cloth );
    weigh( &cloth, def->masses );
    if ( params->stiffness == TRIANGLE_ORACLE_STIFFNESS_MATERIAL )
    {
        become_material( &cloth, def );
    }
    for ( int i = 0; i < cloth.count; ++i )
    {
        cloth.x[i] = cloth.target[i] = def->points[i];
        cloth.freedom[i].m[0][0] = cloth.freedom[i].m[1][1] = cloth.freedom[i].m[2][2] = 1.0;
    }
    return cloth;
}

void triangle_oracle_destroy( triangle_oracle* cloth )
{
    void* blocks[] = { cloth->link,   cloth->term,    cloth->neighbours, cloth->weight,     cloth->true_mass,
                       cloth->mass,   cloth->x,       cloth->v,          cloth->x_before,   cloth->v_before,
                       cloth->pinned, cloth->target,  cloth->freedom,    cloth->prescribed, cloth->push,
                       cloth->change, cloth->impulse, cloth->contact,    cloth->rest,       cloth->triangles };
    plate_oracle_destroy( &cloth->plate );
    for ( size_t k = 0; k < sizeof( blocks ) / sizeof( blocks[0] ); ++k )
    {
        free( blocks[k] );
    }
    *cloth = ( triangle_oracle ){ 0 };
}

void triangle_oracle_pin( triangle_oracle* cloth, int vertex )
{
    cloth->pinned[vertex] = true;
    cloth->target[vertex] = cloth->x[vertex];
    if ( cloth->triangle_count > 0 )
    {
        make_plate( cloth );
    }
}

// ---- triangles ----

static const double pi = 3.14159265358979323846;
static const double3 zero = { 0.0, 0.0, 0.0 };

// ---- the arc ----

// (-1)^n u^2n c_n / (2n+1)! from n = 1: the remainder when cosine and sine cancel, which they do below u = 1.
static double cancelled_series( double u, double ( *coefficient )( int n ) )
{
    double power = 1.0, sum = 0.0;
    for ( int n = 1; n <= 12; ++n )
    {
        power *= -u * u / ( 2.0 * n * ( 2.0 * n + 1.0 ) );
        sum += power * coefficient( n );
    }
    return sum;
}

static double two_n( int n )
{
    return 2.0 * n;
}

static double four_n_one_less_n( int n )
{
    return 4.0 * n * ( 1.0 - n );
}

// G = cos u - sinc u.
static double bow( double u )
{
    return u < 1.0 ? cancelled_series( u, two_n ) : cos( u ) - sin( u ) / u;
}

// 3 G + u sin u.
static double bow_slope( double u )
{
    return u < 1.0 ? cancelled_series( u, four_n_one_less_n ) : 3.0 * bow( u ) + u * sin( u );
}

static double triangle_oracle_sinc( double u )
{
    return u == 0.0 ? 1.0 : sin( u ) / u;
}

// u in [0, pi] with sin u / u = y; 0 for y >= 1, pi for y <= 0. By Newton, residual below 1e-14.
static double triangle_oracle_sinc_inverse( double y )
{
    if ( y >= 1.0 || y <= 0.0 )
    {
        return y >= 1.0 ? 0.0 : pi;
    }
    double u = sqrt( 6.0 * ( 1.0 - y ) );
    for ( int k = 0; k < 20 && fabs( triangle_oracle_sinc( u ) - y ) > 1e-16; ++k )
    {
        // d sinc / du = G / u
        u = fmin( fmax( u - ( triangle_oracle_sinc( u ) - y ) * u / bow( u ), 1e-12 ), pi );
    }
    return u;
}

double triangle_oracle_arc_load( double y )
{
    const double u = triangle_oracle_sinc_inverse( y );
    return u < 1e-6 ? -12.0 : 4.0 * u * u / bow( u );
}

double triangle_oracle_arc_slope( double y )
{
    const double u = triangle_oracle_sinc_inverse( y ), g = bow( u );
    return u < 1e-6 ? 7.2 : 4.0 * u * u * bow_slope( u ) / ( g * g * g );
}

double triangle_oracle_arc_energy( double y )
{
    const double u = triangle_oracle_sinc_inverse( y );
    return 2.0 * u * u;
}

// (12): the larger of the load and ramp (y - 1). @param ramp c_b L^3 / k_b
static double triangle_oracle_ramped_load( double y, double ramp )
{
    return y < 1.0 ? fmax( triangle_oracle_arc_load( y ), ramp * ( y - 1.0 ) ) : 0.0;
}

static double triangle_oracle_ramped_slope( double y, double ramp )
{
    if ( y >= 1.0 )
    {
        return 0.0;
    }
    return triangle_oracle_arc_load( y ) < ramp * ( y - 1.0 ) ? ramp : triangle_oracle_arc_slope( y );
}

// Whether the arc's load is above the ramp, or, for `slope`, is steeper.
static bool is_above( double y, double ramp, bool slope )
{
    return slope ? triangle_oracle_arc_slope( y ) > ramp : triangle_oracle_arc_load( y ) > ramp * ( y - 1.0 );
}

// Find the length between two lengths where that changes, by bisection.
static double changes_between( double low, double high, double ramp, bool slope )
{
    const bool at_low = is_above( low, ramp, slope );
    for ( int k = 0; k < 100; ++k )
    {
        const double middle = 0.5 * ( low + high );
        *( is_above( middle, ramp, slope ) == at_low ? &low : &high ) = middle;
    }
    return 0.5 * ( low + high );
}

// The integral of the ramped load from 1 to y, >= 0: its derivative by y is that load. Below a ramp of about 34 the
// arc is never reached; up to 4 pi^2 the ramp is larger again near y = 0.
static double triangle_oracle_ramped_energy( double y, double ramp )
{
    const double at = fmax( y, 0.0 ), of_ramp = 0.5 * ramp * ( 1.0 - at ) * ( 1.0 - at );
    if ( at >= 1.0 )
    {
        return 0.0;
    }
    // The arc's load is concave in y, so it exceeds the ramp in a single interval of lengths; the difference is
    // largest where both slopes are equal.
    const double top = is_above( 0.0, ramp, true ) ? changes_between( 0.0, 1.0, ramp, true ) : 0.0;
    if ( !is_above( top, ramp, false ) )
    {
        return of_ramp;
    }
    const double upper = changes_between( top, 1.0, ramp, false );
    const double lower = is_above( 0.0, ramp, false ) ? 0.0 : changes_between( 0.0, top, ramp, false );
    if ( at >= upper )
    {
        return of_ramp;
    }
    const double arc = triangle_oracle_arc_energy( fmax( at, lower ) ) - triangle_oracle_arc_energy( upper );
    const double under = at < lower ? of_ramp - 0.5 * ramp * ( 1.0 - lower ) * ( 1.0 - lower ) : 0.0;
    return 0.5 * ramp * ( 1.0 - upper ) * ( 1.0 - upper ) + arc + under;
}

// ---- forces ----

// (5) to (8): a link that is shorter than at rest has no stretch.
static void stretch_term( const triangle_oracle_link* link, triangle_oracle_term* term )
{
    const double beyond = term->length - link->length;
    if ( beyond > 0.0 )
    {
        term->force = link->stretch * beyond;
        term->k1 = link->stretch;
        term->k2 = link->stretch * ( 1.0 - link->length / term->length );
    }
}

// (9) to (13): a link that is longer than at rest has no bend.
static void bend_term( const triangle_oracle_link* link, bool full, triangle_oracle_term* term )
{
    const double l = link->length, y = term->length / l;
    if ( y < 1.0 && link->bend > 0.0 )
    {
        const double ramp = link->ramp * l * l * l / link->bend;
        term->force = link->bend / ( l * l ) * triangle_oracle_ramped_load( y, ramp );
        term->k1 = link->bend / ( l * l * l ) * triangle_oracle_ramped_slope( y, ramp );
        term->k2 = full ? term->force / term->length : 0.0;
    }
}

triangle_oracle_term triangle_oracle_term_at( const triangle_oracle* cloth, int link, const double3* x )
{
    const triangle_oracle_link* l = cloth->link + link;
    const double3 way = double3_sub( x[l->j], x[l->i] );
    triangle_oracle_term term = { .length = double3_length( way ) };
    if ( term.length > 0.0 )
    {
        term.direction = double3_scale( 1.0 / term.length, way );
        if ( l->bends )
        {
            bend_term( l, cloth->params.jacobian == TRIANGLE_ORACLE_JACOBIAN_FULL, &term );
        }
        else
        {
            stretch_term( l, &term );
        }
    }
    term.force *= l->scale;
    term.k1 *= l->scale;
    term.k2 *= l->scale;
    return term;
}

void triangle_oracle_forces( const triangle_oracle* cloth, const double3* x, double3* force )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = zero;
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_term term = triangle_oracle_term_at( cloth, k, x );
        force[i] = double3_add_scaled( force[i], term.force, term.direction );
        force[j] = double3_add_scaled( force[j], -term.force, term.direction );
    }
    double3* bent = calloc( (size_t)cloth->count, sizeof( double3 ) );
    plate_oracle_multiply( &cloth->plate, x, cloth->count, bent );
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = double3_add_scaled( force[i], -cloth->params.bend_rigidity, bent[i] );
    }
    free( bent );
}

void triangle_oracle_damping_forces( const triangle_oracle* cloth, const double3* x, const double3* v,
                                     double3* force )
{
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = zero;
    }
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        const int i = cloth->link[k].i, j = cloth->link[k].j;
        const triangle_oracle_term term = triangle_oracle_term_at( cloth, k, x );
        const double3 apart = double3_sub( v[i], v[j] );
        const double rate = term.length > 0.0 ? cloth->link[k].scale * cloth->link[k].damping : 0.0;
        force[i] = double3_add_scaled( force[i], -rate, apart );
        force[j] = double3_add_scaled( force[j], rate, apart );
    }
}

void triangle_oracle_printed( const triangle_oracle* cloth, const double3* x, const double3* v, double3* force )
{
    double3* damping = calloc( (size_t)cloth->count, sizeof( double3 ) );
    triangle_oracle_forces( cloth, x, force );
    triangle_oracle_damping_forces( cloth, x, v, damping );
    for ( int i = 0; i < cloth->count; ++i )
    {
        force[i] = double3_scale( cloth->weight[i], double3_add( force[i], damping[i] ) );
    }
    free( damping );
}

// ---- energies ----

// (5), or the potential of (12), of one link, scale included, J.
static double triangle_oracle_energy_at( const triangle_oracle* cloth, int link, const double3* x )
{
    const triangle_oracle_link* l = cloth->link + link;
    const double r = double3_distance( x[l->i], x[l->j] ), beyond = fmax( r - l->length, 0.0 );
    if ( !l->bends )
    {
        return l->scale * 0.5 * l->stretch * beyond * beyond;
    }
    if ( !( l->bend > 0.0 ) )
    {
        return 0.0;
    }
    const double ramp = l->ramp * l->length * l->length * l->length / l->bend;
    return l->scale * l->bend / l->length * triangle_oracle_ramped_energy( r / l->length, ramp );
}

static double energy_of( const triangle_oracle* cloth, const double3* x, bool bends )
{
    double sum = 0.0;
    for ( int k = 0; k < cloth->link_count; ++k )
    {
        sum += cloth->link[k].bends == bends ? triangle_oracle_energy_at( cloth, k, x ) : 0.0;
    }
    return sum;
}

double triangle_oracle_stretch_energy( const triangle_oracle* cloth, const double3* x )
{
    return energy_of( cloth, x, false );
}

double triangle_oracle_bend_energy( const triangle_oracle* cloth, const double3* x )
{
    return energy_of( cloth, x, true ) + cloth->params.bend_rigidity * plate_oracle_energy( &cloth->plate, x );
}

double3 triangle_oracle_momentum( const triangle_oracle* cloth )
{
    double3 sum = zero;
    for ( int i = 0; i < cloth->count; ++i )
    {
        sum = double3_add_scaled( sum, cloth->mass[i], cloth->v[i] );
    }
    return sum;
}
