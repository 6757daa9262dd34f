// What the gate says of a row beside its base.
#include "unit.h"

#include "gate_check.h"

#include <math.h>

// A measurement of 1000 instructions and more in one of three passes.
static suite_measurement measured( double more )
{
    suite_measurement m = { .hash = 1, .steps = 10, .pass_count = 3 };
    m.values[SUITE_INSTRUCTIONS] = 1000.0 + more;
    m.passes[0] = ( suite_pass ){ .name = "cloth.air", .instructions = 400.0 };
    m.passes[1] = ( suite_pass ){ .name = "cloth.bending", .instructions = 500.0 + more };
    m.passes[2] = ( suite_pass ){ .name = "links.xpbd", .instructions = 100.0 };
    return m;
}

static gate_row_check check( double more, bool compares_counts )
{
    suite_row row = { .name = "flag" };
    row.budgets[SUITE_INSTRUCTIONS].relative = 0.005;
    static gate_base_row base_row;
    base_row = ( gate_base_row ){ .name = "flag", .measured = measured( 0.0 ) };
    const gate_base base = { .rows = &base_row, .row_count = 1 };
    const suite_measurement now = measured( more );
    gate_row_check out;
    gate_check_row( &row, &base, compares_counts, &now, &out );
    return out;
}

TEST( the_pass_that_grew_is_named )
{
    const gate_row_check out = check( 50.0, true );
    assert_int_equal( out.state, GATE_WORSE );
    assert_non_null( strstr( out.message, "cloth.bending +10.00 %" ) );
    assert_null( strstr( out.message, "cloth.air" ) );
}

TEST( growth_within_the_budget_passes )
{
    assert_int_equal( check( 4.0, true ).state, GATE_SAME );
    assert_int_equal( check( -500.0, true ).state, GATE_SAME );
    assert_int_equal( check( 50.0, false ).state, GATE_SAME ); // of another compiler
}

// An error that is not finite is worse than any.
TEST( errors_have_a_budget )
{
    static const struct
    {
        double now;
        gate_state expected;
    } all[] = { { 1e-3, GATE_SAME }, { 1.04e-3, GATE_SAME },   { 1.06e-3, GATE_WORSE },
                { 1e-4, GATE_SAME }, { INFINITY, GATE_WORSE }, { NAN, GATE_SAME } };
    for ( size_t i = 0; i < WISP_COUNT( all ); ++i )
    {
        suite_row row = { .name = "flag" };
        row.budgets[SUITE_ERROR].relative = 0.05;
        gate_base_row base_row = { .name = "flag", .measured = measured( 0.0 ) };
        base_row.measured.values[SUITE_ERROR] = 1e-3;
        const gate_base base = { .rows = &base_row, .row_count = 1 };
        suite_measurement now = measured( 0.0 );
        now.values[SUITE_ERROR] = all[i].now;
        gate_row_check out;
        gate_check_row( &row, &base, true, &now, &out );
        assert_int_equal( out.state, all[i].expected );
    }
}
