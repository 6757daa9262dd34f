#include "coarse_oracle.h"

#include <stdlib.h>
#include <string.h>

void coarse_oracle_project( coarse_oracle_link* link, double wa, double wb, double3* a, double3* b )
{
    const double3 d = double3_sub( *a, *b );
    const double l = double3_length( d );
    if ( l == 0.0 || wa + wb == 0.0 )
    {
        return;
    }
    const double c = l > link->rest ? l - link->rest : l < link->lower ? l - link->lower : 0.0;
    double next = link->lambda - link->relaxation * ( c + link->alpha * link->lambda ) / ( wa + wb + link->alpha );
    const double floor = fmax( link->lambda, 0.0 );
    if ( next > floor )
    {
        next = floor + 0.5 * ( next - floor );
    }
    const double step = ( next - link->lambda ) / l;
    link->lambda = next;
    *a = double3_add( *a, double3_scale( wa * step, d ) );
    *b = double3_sub( *b, double3_scale( wb * step, d ) );
}

double coarse_oracle_lower( double length, double rest, double chain, double chain_rest )
{
    return fmin( rest, length + rest * fmin( 0.1, fmax( 0.0, 1.0 - chain / chain_rest ) ) );
}

// ---- a surface ----

typedef struct sheet
{
    const wisp_fabric_level* level;
    double3 *x, *began; // [row_count]
    double* w;          // [row_count]
    int number;
    const double3* previous; // [slot_count] where the substep begins
} sheet;

static void* zeros( int count, size_t size )
{
    void* p = calloc( (size_t)count + 1, size );
    if ( p == NULL )
    {
        abort();
    }
    return p;
}

void coarse_oracle_make( const wisp_fabric* f, const float* position, coarse_oracle* out )
{
    const int rows = f->levels[f->level_count - 1].row_count;
    *out = ( coarse_oracle ){ .fabric = f, .substeps = 1, .passes = 10 };
    double3** own[] = { &out->start, &out->change, &out->lag, &out->before };
    for ( int k = 0; k < 4; ++k )
    {
        *own[k] = zeros( rows, sizeof( double3 ) );
    }
    out->x = zeros( f->slot_count, sizeof( double3 ) );
    out->v = zeros( f->slot_count, sizeof( double3 ) );
    out->w = zeros( f->slot_count, sizeof( double ) );
    for ( int i = 0; i < f->slot_count; ++i )
    {
        out->x[i] = double3_from( position + 4 * i );
        out->w[i] = (double)position[4 * i + 3];
    }
}

void coarse_oracle_free( coarse_oracle* o )
{
    void* all[] = { o->x, o->v, o->w, o->start, o->change, o->lag, o->before };
    for ( size_t i = 0; i < sizeof( all ) / sizeof( all[0] ); ++i )
    {
        free( all[i] );
    }
}

static double weight_of( const wisp_fabric_level* level, int finer_row, int k, int* parent )
{
    const int at = ( finer_row / 8 * WISP_FABRIC_PARENTS + k ) * 8 + finer_row % 8;
    *parent = level->parent_x4[at] / 4;
    return (double)level->weight[at];
}

// Masses P^T m of every level; a row is pinned where the surface is.
static void find_masses( const coarse_oracle* o, sheet* sheets )
{
    double* finer = zeros( o->fabric->slot_count, sizeof( double ) );
    for ( int i = 0; i < o->fabric->slot_count; ++i )
    {
        finer[i] = o->w[i] > 0.0 ? 1.0 / o->w[i] : 0.0;
    }
    for ( int l = 0; l < o->fabric->level_count; ++l )
    {
        const wisp_fabric_level* level = sheets[l].level;
        double* mass = zeros( level->row_count, sizeof( double ) );
        for ( int row = 0; row < level->finer_row_count; ++row )
        {
            for ( int k = 0, parent; k < WISP_FABRIC_PARENTS; ++k )
            {
                const double weight = weight_of( level, row, k, &parent );
                mass[parent] += weight * finer[row];
            }
        }
        for ( int row = 0; row < level->row_count; ++row )
        {
            const bool moves = row < level->vertex_count && o->w[level->slot_x4[row] / 4] > 0.0;
            mass[row] = moves ? mass[row] : 0.0;
            sheets[l].w[row] = mass[row] > 0.0 ? 1.0 / mass[row] : 0.0;
        }
        free( finer );
        finer = mass;
    }
    free( finer );
}

static double chain_length( const double3* x, const wisp_fabric_level* level, int lane )
{
    double sum = 0.0;
    const int group = lane / 8;
    for ( int e = level->chain_begin[group] + 1; e < level->chain_begin[group + 1]; ++e )
    {
        const double3 a = x[level->chain_x4[e - 1][lane % 8] / 4], b = x[level->chain_x4[e][lane % 8] / 4];
        sum += double3_length( double3_sub( b, a ) );
    }
    return sum;
}

// The row of the next finer sheet that stands for a pinned slot: of the rows that it follows the one with the largest weight, and so
// on from sheet to sheet. -1 if there is none, or if it is the row of another pinned vertex.
static int stand_in_of( const coarse_oracle* o, int number, int slot )
{
    int row = slot;
    for ( int l = 0; l < number; ++l )
    {
        const wisp_fabric_level* level = o->fabric->levels + l;
        int best = -1;
        double most = 0.0;
        for ( int k = 0, parent; k < WISP_FABRIC_PARENTS; ++k )
        {
            const double weight = weight_of( level, row, k, &parent );
            best = weight > most ? parent : best;
            most = fmax( most, weight );
        }
        if ( best < 0 || ( level->slot_x4[best] != 4 * slot && o->w[level->slot_x4[best] / 4] == 0.0 ) )
        {
            return -1;
        }
        row = best;
    }
    return row;
}

// Moves the points of pinned vertices with them, by a fraction of their way: C = sum weight (x - x_previous) - fraction d.
static void project_pins( const coarse_oracle* o, sheet* s, double fraction )
{
    for ( int slot = 0; slot < o->fabric->vertex_count; ++slot )
    {
        const int stand_in = o->w[slot] == 0.0 ? stand_in_of( o, s->number, slot ) : -1;
        double3 c = double3_scale( -fraction, double3_sub( o->x[slot], s->previous[slot] ) );
        double sum = 0.0;
        for ( int k = 0, parent; k < WISP_FABRIC_PARENTS && stand_in >= 0; ++k )
        {
            const double weight = weight_of( s->level, stand_in, k, &parent );
            const double3 moved = double3_sub( s->x[parent], s->previous[s->level->slot_x4[parent] / 4] );
            c = weight > 0.0 ? double3_add( c, double3_scale( weight, moved ) ) : c;
            sum += weight * weight * s->w[parent];
        }
        for ( int k = 0, parent; k < WISP_FABRIC_PARENTS && sum > 0.0; ++k )
        {
            const double weight = weight_of( s->level, stand_in, k, &parent );
            s->x[parent] = double3_sub( s->x[parent], double3_scale( weight * s->w[parent] / sum, c ) );
        }
    }
}

// @param fraction of the substep of the surface that ends
static void project( const coarse_oracle* o, sheet* s, double* lower, double fraction, bool find_lower, double h,
                     int passes )
{
    const wisp_fabric_level* level = s->level;
    coarse_oracle_link* links = zeros( level->schedule.slot_count, sizeof( coarse_oracle_link ) );
    for ( int i = 0; i < level->schedule.slot_count; ++i )
    {
        const int a = level->a_x4[i] / 4, b = level->b_x4[i] / 4;
        const double rest = (double)level->rest[i];
        if ( level->schedule.constraint[i] < 0 )
        {
            continue;
        }
        if ( find_lower )
        {
            const double3 from_a = s->previous[level->slot_x4[a] / 4], from_b = s->previous[level->slot_x4[b] / 4];
            const double first = double3_length( double3_sub( from_a, from_b ) );
            const double now = double3_length( double3_sub( s->x[a], s->x[b] ) );
            lower[i] = coarse_oracle_lower( first, rest, chain_length( s->previous, level, i ),
                                            (double)level->chain_rest[i] ) -
                       fmax( 0.0, fmin( first, rest ) - now - o->held * rest );
        }
        const double alpha = o->compliance / (double)level->fraction[i] / ( h * h );
        links[i] = ( coarse_oracle_link ){ rest, lower[i], alpha, 0.0, o->relaxation };
    }
    for ( int pass = 0; pass < passes; ++pass )
    {
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const int a = level->a_x4[i] / 4, b = level->b_x4[i] / 4;
            if ( level->schedule.constraint[i] >= 0 )
            {
                coarse_oracle_project( &links[i], s->w[a], s->w[b], &s->x[a], &s->x[b] );
            }
        }
        project_pins( o, s, fraction );
    }
    free( links );
}

static double3 limited( double3 v, double most )
{
    const double d2 = double3_dot( v, v );
    return d2 > most * most ? double3_scale( most * most / d2, v ) : v;
}

static double mean_rest_of( const wisp_fabric_level* level )
{
    double sum = 0.0;
    for ( int i = 0; i < level->schedule.slot_count; ++i )
    {
        sum += level->schedule.constraint[i] >= 0 ? (double)level->rest[i] : 0.0;
    }
    return sum / level->link_count;
}

// The coarsest sheet: BDF2 with the substep before as it follows from the history, which is shortened where it would move a row by
// more than a tenth of a link in a substep of the surface.
static void move_coarsest( coarse_oracle* o, sheet* s, const double3* previous, const double3* pull, double h )
{
    const wisp_fabric_level* level = s->level;
    const double dt = h / o->substeps, fastest = 0.1 * mean_rest_of( level ) / ( h * h );
    double3* from = zeros( level->row_count, sizeof( double3 ) );
    double* lower = zeros( level->schedule.slot_count, sizeof( double ) );
    for ( int row = 0; row < level->vertex_count; ++row )
    {
        s->x[row] = previous[level->slot_x4[row] / 4];
    }
    for ( int j = 0; j < o->substeps; ++j )
    {
        const bool bdf2 = o->has_history;
        const double he = bdf2 ? 2.0 / 3.0 * dt : dt;
        for ( int row = 0; row < level->vertex_count; ++row )
        {
            const double3 x = s->x[row], v = o->start[row];
            from[row] = x;
            if ( s->w[row] == 0.0 )
            {
                s->x[row] =
                    double3_add( x, double3_scale( 1.0 / ( o->substeps - j ), double3_sub( s->began[row], x ) ) );
                continue;
            }
            // x_1 and v_1 of the substep before
            const double3 v1 = double3_sub( v, double3_scale( dt, o->change[row] ) );
            const double3 d1 = double3_sub( double3_scale( dt, v ), double3_scale( dt * dt, o->lag[row] ) );
            const double3 x1 = double3_sub( x, d1 );
            const double3 xt = bdf2 ? double3_scale( 1.0 / 3.0, double3_sub( double3_scale( 4.0, x ), x1 ) ) : x;
            const double3 vt = bdf2 ? double3_scale( 1.0 / 3.0, double3_sub( double3_scale( 4.0, v ), v1 ) ) : v;
            s->x[row] = double3_add( xt, double3_scale( he, double3_add( vt, double3_scale( he, pull[row] ) ) ) );
        }
        project( o, s, lower, ( j + 1.0 ) / o->substeps, j == 0, he, o->passes );
        for ( int row = 0; row < level->vertex_count; ++row )
        {
            const double3 v = o->start[row], d = double3_sub( s->x[row], from[row] ),
                          e = double3_scale( 1.0 / dt, d );
            const double3 d1 = double3_sub( double3_scale( dt, v ), double3_scale( dt * dt, o->lag[row] ) );
            const double3 second = double3_scale( 0.5 / dt, double3_sub( double3_scale( 3.0, d ), d1 ) );
            const double3 added = limited( double3_sub( second, e ), 0.5 * fastest * h );
            const double3 end = bdf2 && s->w[row] > 0.0 ? double3_add( e, added ) : e;
            o->change[row] = limited( double3_scale( 1.0 / dt, double3_sub( end, v ) ), fastest );
            o->lag[row] = limited( double3_scale( 1.0 / dt, double3_sub( end, e ) ), fastest );
            o->start[row] = end;
        }
        o->has_history = true;
    }
    free( from );
    free( lower );
}

// Adds values of a level to the rows of the next finer one that move.
static void prolong( const wisp_fabric_level* level, const double3* value, const double* w, double3* target )
{
    for ( int row = 0; row < level->finer_row_count; ++row )
    {
        for ( int k = 0, parent; k < WISP_FABRIC_PARENTS && w[row] > 0.0; ++k )
        {
            const double weight = weight_of( level, row, k, &parent );
            target[row] = double3_add( target[row], double3_scale( weight, value[parent] ) );
        }
    }
}

static void measure( sheet* s )
{
    for ( int row = 0; row < s->level->row_count; ++row )
    {
        s->began[row] =
            row < s->level->vertex_count ? double3_sub( s->x[row], s->began[row] ) : double3_make( 0, 0, 0 );
    }
}

// Half of the change of the surface's mean velocity limits what second order adds.
static double fraction_of( double3 d, double3 c )
{
    const double d2 = double3_dot( d, d ), cd = double3_dot( c, d );
    return 2.0 * cd >= d2 || d2 <= 1e-8 * double3_dot( c, c ) ? 1.0 : cd > 0.0 ? 2.0 * cd / d2 : 0.0;
}

// Of what is added to a row, it keeps all if the mean of it and its neighbours has 0.6 of that, and nothing at 0.3.
static void share( const wisp_fabric_level* level, double3* value )
{
    double3* sum = zeros( level->row_count, sizeof( double3 ) );
    double* count = zeros( level->row_count, sizeof( double ) );
    for ( int i = 0; i < level->schedule.slot_count; ++i )
    {
        const int a = level->a_x4[i] / 4, b = level->b_x4[i] / 4;
        const double fraction = (double)level->fraction[i];
        sum[a] = double3_add( sum[a], double3_scale( fraction, value[b] ) );
        sum[b] = double3_add( sum[b], double3_scale( fraction, value[a] ) );
        count[a] += fraction;
        count[b] += fraction;
    }
    for ( int row = 0; row < level->vertex_count; ++row )
    {
        const double3 mean = double3_scale( 1.0 / ( 1.0 + count[row] ), double3_add( value[row], sum[row] ) );
        const double own = double3_dot( value[row], value[row] );
        const double part = own > 0.0 ? double3_dot( mean, value[row] ) / own : 1.0;
        value[row] = double3_scale( fmin( 1.0, fmax( 0.0, ( part - 0.3 ) / 0.3 ) ), value[row] );
    }
    free( sum );
    free( count );
}

static void add_second_order( coarse_oracle* o, sheet* sheets, const double3* mean )
{
    const int top = o->fabric->level_count - 1;
    const wisp_fabric_level* level = sheets[top].level;
    double3* value = zeros( level->row_count, sizeof( double3 ) );
    for ( int row = 0; row < level->vertex_count; ++row )
    {
        const double3 v = o->v[level->slot_x4[row] / 4], d = double3_sub( o->start[row], mean[row] );
        const double s = fraction_of( d, double3_scale( 0.5, double3_sub( v, o->before[row] ) ) );
        o->before[row] = v;
        value[row] = double3_scale( s, d );
        o->change[row] = double3_scale( s, o->change[row] );
        o->lag[row] = double3_scale( s, o->lag[row] );
    }
    share( level, value );
    for ( int l = top; l > 0; --l )
    {
        double3* finer = zeros( sheets[l - 1].level->row_count, sizeof( double3 ) );
        prolong( sheets[l].level, value, sheets[l - 1].w, finer );
        free( value );
        value = finer;
    }
    prolong( sheets[0].level, value, o->w, o->v );
    free( value );
    for ( int row = 0; row < level->vertex_count; ++row )
    {
        o->start[row] = o->v[level->slot_x4[row] / 4];
    }
}

static void project_surface( coarse_oracle* o, double h )
{
    const wisp_fabric* f = o->fabric;
    const double alpha = o->compliance / ( h * h );
    for ( int i = 0; i < f->link_order.slot_count; ++i )
    {
        const int a = f->link_a_x4[i] / 4, b = f->link_b_x4[i] / 4;
        const double sum = o->w[a] + o->w[b];
        if ( f->link_order.constraint[i] >= 0 && sum > 0.0 )
        {
            const double3 d = double3_sub( o->x[a], o->x[b] );
            const double l = double3_length( d ), step = -( l - (double)f->link_rest[i] ) / ( sum + alpha ) / l;
            o->x[a] = double3_add( o->x[a], double3_scale( o->w[a] * step, d ) );
            o->x[b] = double3_sub( o->x[b], double3_scale( o->w[b] * step, d ) );
        }
    }
}

void coarse_oracle_step( coarse_oracle* o, double h )
{
    o->relaxation = 1.5 * fmin( 1.0, 120.0 * h );
    o->held = 0.3 * h;
    const wisp_fabric* f = o->fabric;
    const int top = f->level_count - 1;
    sheet sheets[WISP_FABRIC_MAX_LEVELS];
    double3* previous = zeros( f->slot_count, sizeof( double3 ) );
    memcpy( previous, o->x, (size_t)f->slot_count * sizeof( double3 ) );
    for ( int i = 0; i < f->slot_count; ++i )
    {
        if ( o->w[i] > 0.0 )
        {
            o->v[i] = double3_add( o->v[i], double3_scale( h, o->gravity ) );
            o->x[i] = double3_add( o->x[i], double3_scale( h, o->v[i] ) );
        }
    }
    for ( int l = 0; l <= top; ++l )
    {
        const int rows = f->levels[l].row_count;
        sheets[l] = ( sheet ){ &f->levels[l],
                               zeros( rows, sizeof( double3 ) ),
                               zeros( rows, sizeof( double3 ) ),
                               zeros( rows, sizeof( double ) ),
                               l,
                               previous };
        for ( int row = 0; row < f->levels[l].vertex_count; ++row )
        {
            sheets[l].began[row] = o->x[f->levels[l].slot_x4[row] / 4];
        }
    }
    find_masses( o, sheets );
    double3* pull = zeros( f->levels[top].row_count, sizeof( double3 ) );
    double3* mean = zeros( f->levels[top].row_count, sizeof( double3 ) );
    for ( int row = 0; row < f->levels[top].vertex_count; ++row )
    {
        const double3 arrived = o->v[f->levels[top].slot_x4[row] / 4];
        pull[row] = double3_scale( 1.0 / h, double3_sub( arrived, o->start[row] ) );
    }
    move_coarsest( o, &sheets[top], previous, pull, h );
    for ( int row = 0; row < f->levels[top].vertex_count; ++row )
    {
        mean[row] =
            double3_scale( 1.0 / h, double3_sub( sheets[top].x[row], previous[f->levels[top].slot_x4[row] / 4] ) );
    }
    measure( &sheets[top] );
    for ( int l = top - 1; l >= 0; --l )
    {
        sheet* s = &sheets[l];
        double* lower = zeros( s->level->schedule.slot_count, sizeof( double ) );
        memcpy( s->x, s->began, (size_t)s->level->row_count * sizeof( double3 ) );
        prolong( sheets[l + 1].level, sheets[l + 1].began, s->w, s->x );
        project( o, s, lower, 1.0, true, h, 1 );
        measure( s );
        free( lower );
    }
    prolong( sheets[0].level, sheets[0].began, o->w, o->x );
    project_surface( o, h );
    for ( int i = 0; i < f->slot_count; ++i )
    {
        o->v[i] = double3_scale( 1.0 / h, double3_sub( o->x[i], previous[i] ) );
    }
    add_second_order( o, sheets, mean );
    for ( int l = 0; l <= top; ++l )
    {
        free( sheets[l].x );
        free( sheets[l].began );
        free( sheets[l].w );
    }
    free( previous );
    free( pull );
    free( mean );
}
