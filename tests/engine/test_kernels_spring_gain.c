// The potential that links gain in a motion: that of formulas in double precision, and the same bits by every table.
#include "springs_state.h"

// Rows move by up to as much as they are apart, so that links go slack and taut and arcs buckle.
static wisp_spring_args motion_of( springs* s )
{
    wisp_spring_args args = spring_args( s, 0 );
    for ( int row = 0; row < VERTICES; ++row )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->start[row][k] = s->position[row][k] + test_random_float( row, 50 + k, -0.05f, 0.05f );
        }
    }
    args.base_position = s->start[0];
    return args;
}

static double potential_of( const spring* l, const float ( *position )[4] )
{
    const double r = double3_distance( double3_from( position[l->i] ), double3_from( position[l->j] ) );
    const double rest = (double)l->rest, load = (double)l->load, ramp_end = (double)l->ramp_end;
    if ( l->bends == false )
    {
        return 0.5 * load * fmax( 0.0, r - rest ) * fmax( 0.0, r - rest );
    }
    const double y = fmin( r / rest, 1.0 ), straight = rest * fmin( 1.0 - y, 1.0 - ramp_end );
    const double arc = triangle_oracle_arc_energy( fmin( y, ramp_end ) ) - triangle_oracle_arc_energy( ramp_end );
    return 0.5 * (double)l->ramp * straight * straight + load * rest * arc;
}

TEST( a_gain_is_the_change_of_the_potential_of_links )
{
    springs* s = new_springs();
    const wisp_spring_args args = motion_of( s );
    double gain = 0.0, stored = 0.0, off = 0.0;
    int slack = 0, buckled = 0;
    for ( int k = 0; k < s->link_count; ++k )
    {
        const spring* l = s->link + k;
        const double before = potential_of( l, (const float( * )[4])s->start ),
                     after = potential_of( l, (const float( * )[4])s->position );
        gain += after - before;
        stored += after;
        // a length has some four roundings, and the polynomial is within 3e-7 of 6
        off += 1e-6 * ( before + after ) + 8.0 * EPSILON * 0.2 * sqrt( 400.0 * ( before + after ) );
        slack += l->bends == false && ( before == 0.0 ) != ( after == 0.0 ) ? 1 : 0;
        buckled += l->bends && l->ramp_end > 0.0f && after > before ? 1 : 0;
    }
    assert_true( slack > 100 && buckled > 100 );
    const wisp_spring_gain found = widest_table()->spring_gain( &args, 0, SLICES );
    assert_near( found.gain, gain, off, "gain of links", s->link_count );
    assert_near( found.stored, stored, off, "potential of links", s->link_count );
    // arcs alone, which links that stretch would hide
    for ( int part = 0; part < 2 * SLICES; part += 2 )
    {
        memset( s->load[s->begin[part]], 0, (size_t)( s->begin[part + 1] - s->begin[part] ) * 32 );
    }
    gain = stored = off = 0.0;
    for ( int k = 0; k < s->link_count; ++k )
    {
        const spring* l = s->link + k;
        const double before = l->bends ? potential_of( l, (const float( * )[4])s->start ) : 0.0,
                     after = l->bends ? potential_of( l, (const float( * )[4])s->position ) : 0.0;
        gain += after - before;
        stored += after;
        off += 1e-6 * ( before + after ) + 8.0 * EPSILON * 0.2 * sqrt( 80.0 * ( before + after ) );
    }
    const wisp_spring_gain arcs_only = widest_table()->spring_gain( &args, 0, SLICES );
    assert_near( arcs_only.gain, gain, off, "gain of arcs", s->link_count );
    assert_near( arcs_only.stored, stored, off, "potential of arcs", s->link_count );
    assert_true( off < 1e-2 * stored );
    free( s );
}

TEST( every_table_gains_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    springs* s = new_springs();
    const wisp_spring_args args = motion_of( s );
    const wisp_spring_gain first = tables[0]->spring_gain( &args, 0, SLICES );
    for ( int t = 1; t < count; ++t )
    {
        const wisp_spring_gain found = tables[t]->spring_gain( &args, 0, SLICES );
        assert_true( found.gain == first.gain && found.stored == first.stored );
    }
    free( s );
}
