// Height fields. The solid is everything below a piecewise linear surface over the xz plane, so whether a point is inside is a
// comparison of heights, and the surface at the same x and z bounds its distance: only cells within that distance are
// searched, outwards from the cell of the point. Beyond the border the heights of the border go on, so of the cells there only
// the row and the column of the point can be the nearest.
#include "solid.h"

bool height_field_is_solid( const wisp_height_field* f )
{
    return f->heights != NULL && f->count_x >= 2 && f->count_z >= 2 && f->spacing > 0.0f && f->spacing <= FLT_MAX;
}

double3 height_field_sample( const wisp_height_field* f, int i, int k )
{
    const int ci = i < 0 ? 0 : ( i >= f->count_x ? f->count_x - 1 : i );
    const int ck = k < 0 ? 0 : ( k >= f->count_z ? f->count_z - 1 : k );
    const double s = (double)f->spacing;
    return ( double3 ){ ( i - 0.5 * ( f->count_x - 1 ) ) * s,
                        (double)f->heights[(size_t)ck * (size_t)f->count_x + (size_t)ci],
                        ( k - 0.5 * ( f->count_z - 1 ) ) * s };
}

// The two triangles of a cell, which face upwards.
static void corners_of( const wisp_height_field* f, int i, int k, int half, double3 corner[3] )
{
    corner[0] = height_field_sample( f, i, k );
    corner[1] = half == 0 ? height_field_sample( f, i, k + 1 ) : height_field_sample( f, i + 1, k + 1 );
    corner[2] = half == 0 ? height_field_sample( f, i + 1, k + 1 ) : height_field_sample( f, i + 1, k );
}

static double3 normal_of( const double3 c[3] )
{
    return double3_unit_or_zero( double3_cross( double3_sub( c[1], c[0] ), double3_sub( c[2], c[0] ) ) );
}

// Coordinates in cells. Far outside the field is constant along the axis, so the cell there may stand for all beyond.
static double cell_coordinate( double x, double spacing, int count )
{
    const double u = x / spacing + 0.5 * ( count - 1 );
    return u < -1e8 ? -1e8 : ( u > 1e8 ? 1e8 : u );
}

typedef struct field_search
{
    const wisp_height_field* field;
    double3 p, nearest, normal;
    double least; // m^2
} field_search;

static void search_cell( field_search* s, int i, int k )
{
    for ( int half = 0; half < 2; ++half )
    {
        double3 c[3];
        corners_of( s->field, i, k, half, c );
        const double3 q = closest_on_triangle( s->p, c[0], c[1], c[2] ), d = double3_sub( s->p, q );
        const double squared = double3_dot( d, d );
        if ( squared < s->least )
        {
            s->least = squared;
            s->nearest = q;
            s->normal = normal_of( c );
        }
    }
}

static double beside( double u, int cell )
{
    return u < cell ? cell - u : ( u > cell + 1 ? u - ( cell + 1 ) : 0.0 );
}

static int nearest_cell( int cell, int count )
{
    return cell < 0 ? 0 : ( cell > count - 2 ? count - 2 : cell );
}

// Searches the cells of a row, `apart` cells away.
static void search_row( field_search* s, double u, int i, int k, double apart )
{
    const int count = s->field->count_x, first = nearest_cell( i, count );
    const double spacing = (double)s->field->spacing;
    if ( first != i )
    {
        search_cell( s, i, k );
    }
    for ( int d = 0; d < count - 1; ++d )
    {
        const int sides[2] = { first + d, first - d };
        bool is_near = false;
        for ( int side = 0; side < ( d == 0 ? 1 : 2 ); ++side )
        {
            const double away = beside( u, sides[side] );
            const bool is_cell = sides[side] >= 0 && sides[side] <= count - 2;
            if ( is_cell && spacing * spacing * ( away * away + apart * apart ) < s->least )
            {
                search_cell( s, sides[side], k );
                is_near = true;
            }
        }
        if ( is_near == false )
        {
            return;
        }
    }
}

static void search_rows( field_search* s, double u, double w, int i, int k )
{
    const int count = s->field->count_z, first = nearest_cell( k, count );
    const double spacing = (double)s->field->spacing;
    if ( first != k )
    {
        search_row( s, u, i, k, 0.0 );
    }
    for ( int d = 0; d < count - 1; ++d )
    {
        const int sides[2] = { first + d, first - d };
        bool is_near = false;
        for ( int side = 0; side < ( d == 0 ? 1 : 2 ); ++side )
        {
            const double apart = beside( w, sides[side] );
            const bool is_row = sides[side] >= 0 && sides[side] <= count - 2;
            if ( is_row && spacing * apart * spacing * apart < s->least )
            {
                search_row( s, u, i, sides[side], apart );
                is_near = true;
            }
        }
        if ( is_near == false )
        {
            return;
        }
    }
}

static void find_below( const wisp_height_field* f, double3 p, int* i, int* k, double3 corner[3] )
{
    const double u = cell_coordinate( p.x, (double)f->spacing, f->count_x );
    const double w = cell_coordinate( p.z, (double)f->spacing, f->count_z );
    *i = (int)floor( u );
    *k = (int)floor( w );
    corners_of( f, *i, *k, w - *k >= u - *i ? 0 : 1, corner );
}

void height_field_closest( const wisp_height_field* f, double3 p, wisp_surface_point* s )
{
    int i, k;
    double3 c[3];
    find_below( f, p, &i, &k, c );
    const double3 normal = normal_of( c );
    const double gap = p.y - ( c[0].y - ( normal.x * ( p.x - c[0].x ) + normal.z * ( p.z - c[0].z ) ) / normal.y );
    const double3 under = { p.x, p.y - gap, p.z };
    field_search search = { f, p, under, normal, gap * gap };
    search_rows( &search, cell_coordinate( p.x, (double)f->spacing, f->count_x ),
                 cell_coordinate( p.z, (double)f->spacing, f->count_z ), i, k );
    const double distance = sqrt( search.least );
    const double tiny = 1e-9 * (double)f->spacing;
    const double3 away = double3_scale( double3_sub( p, search.nearest ), distance > tiny ? 1.0 / distance : 0.0 );
    const double side = gap < 0.0 ? -1.0 : 1.0;
    s->point = double3_narrow( search.nearest );
    s->normal = double3_narrow( distance > tiny ? double3_scale( away, side ) : search.normal );
    s->distance = (float)( side * distance );
}

// ---- paths ----

// Clips the path by the plane of a triangle, within the triangle seen from above.
static double enter_triangle( const double3 c[3], double3 from, double3 step, double first, double last,
                              double3* normal )
{
    const double3 n = normal_of( c );
    const double height = double3_dot( n, double3_sub( from, c[0] ) ), speed = double3_dot( n, step );
    const double before = height + first * speed, after = height + last * speed;
    if ( !( speed < 0.0 ) || after > 0.0 )
    {
        return SOLID_NEVER;
    }
    *normal = n;
    return before <= 0.0 ? first : -height / speed;
}

// Returns the next time at which u + t v is a whole number from `lower` to `upper`, after a time.
static double next_line( double u, double v, double time, double lower, double upper )
{
    if ( v == 0.0 )
    {
        return SOLID_NEVER;
    }
    const double at = u + time * v;
    const double line = v > 0.0 ? fmax( floor( at + 1e-9 ) + 1.0, lower ) : fmin( ceil( at - 1e-9 ) - 1.0, upper );
    return line < lower || line > upper ? SOLID_NEVER : ( line - u ) / v;
}

// Walks through the cells that the path crosses, seen from above, and through the halves of each.
double height_field_enter( const wisp_height_field* f, double3 from, double3 step, double3* normal )
{
    const double s = (double)f->spacing;
    const double u = from.x / s + 0.5 * ( f->count_x - 1 ), w = from.z / s + 0.5 * ( f->count_z - 1 );
    const double du = step.x / s, dw = step.z / s;
    double time = 0.0;
    while ( time < 1.0 )
    {
        // lines of the grid and diagonals; beyond the border there is none
        const double x = f->count_x - 1, z = f->count_z - 1;
        double end = fmin( fmin( next_line( u, du, time, 0.0, x ), next_line( w, dw, time, 0.0, z ) ),
                           next_line( w - u, dw - du, time, -x, z ) );
        end = end < 1.0 ? end : 1.0;
        double3 c[3];
        int i, k;
        find_below( f, double3_mul_add( from, 0.5 * ( time + end ), step ), &i, &k, c );
        const double found = enter_triangle( c, from, step, time, end, normal );
        if ( found <= 1.0 )
        {
            return found;
        }
        time = end > time ? end : 1.0;
    }
    return SOLID_NEVER;
}
