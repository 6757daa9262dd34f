// The model of cost finds the terms that times were made of, and says how well it predicts.
#include "unit.h"

#include "sweep_merge.h"

#include <math.h>

enum
{
    SIZES = 6,
    ITEMS = 3 * SIZES,
};

typedef struct merged
{
    sweep_part part;
    sweep_record records[ITEMS];
    sweep_merged items[ITEMS];
    sweep_merge merge;
    results out;
} merged;

// Items of six sizes with 1, 4 and 9 substeps. @param disturbed this one takes twice as long
static void make( merged* m, double a, double b, double c, int disturbed )
{
    *m = ( merged ){ .merge = { .parts = &m->part, .part_count = 1, .items = m->items } };
    m->part.header = ( sweep_header ){ .items = ITEMS, .shards = 1 };
    for ( int i = 0; i < ITEMS; ++i )
    {
        sweep_record* r = m->records + i;
        r->vertices = 100 * ( i / 3 + 1 ) * ( i / 3 + 1 );
        r->substeps = ( i % 3 + 1 ) * ( i % 3 + 1 );
        r->time_count = 1;
        r->times[0] = ( sweep_time ){ .workers = 1, .steps = 10 };
        r->times[0].median = ( a + b * r->substeps + c * r->vertices * r->substeps ) * ( i == disturbed ? 2.0 : 1.0 );
        snprintf( r->name, sizeof r->name, "sheet" );
        m->items[i] = ( sweep_merged ){ .record = r, .timed = r };
    }
    sweep_add_models( &m->merge, &m->out );
}

static double cell( const merged* m, int column )
{
    return strtod( results_cell( m->out.tables, 1, column ), NULL );
}

TEST( exact_times_give_their_terms )
{
    static merged m;
    make( &m, 0.02, 0.005, 3e-5, -1 );
    assert_int_equal( m.out.table_count, 1 );
    assert_float_equal( cell( &m, 2 ), 20.0, 0.05 ); // us, three digits are shown
    assert_float_equal( cell( &m, 3 ), 5.0, 0.02 );  // us
    assert_float_equal( cell( &m, 4 ), 30.0, 0.05 ); // ns
    assert_float_equal( cell( &m, 5 ), ITEMS / 2, 0 );
    assert_float_equal( cell( &m, 6 ), ITEMS / 2, 0 );
    assert_float_equal( cell( &m, 8 ), 0.0, 0.05 ); // percent
    results_free( &m.out );
}

// The item in the middle is in the fit or in the check, whichever it is: an error shows.
TEST( an_item_that_does_not_fit_is_told )
{
    for ( int i = 0; i < ITEMS; ++i )
    {
        static merged m;
        make( &m, 0.02, 0.005, 3e-5, i );
        assert_true( cell( &m, 8 ) > 1.0 );
        results_free( &m.out );
    }
}

TEST( too_few_items_and_one_size_give_no_model )
{
    static merged m;
    make( &m, 0.02, 0.005, 3e-5, -1 );
    results_free( &m.out );
    m.out = ( results ){ 0 };
    m.part.header.items = 7;
    sweep_add_models( &m.merge, &m.out );
    assert_int_equal( m.out.table_count, 0 );
    m.part.header.items = ITEMS;
    for ( int i = 0; i < ITEMS; ++i )
    {
        m.records[i].substeps = 4;
        m.records[i].vertices = 100;
    }
    sweep_add_models( &m.merge, &m.out );
    assert_int_equal( m.out.table_count, 0 );
    results_free( &m.out );
}
