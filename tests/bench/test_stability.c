// The case `stability`: the verdict detects the faults of synthetic runs, and every quick cell holds or breaks as
// listed.
#include "bench_tables.h"

#include "stability/stability.h"

// ---- synthetic runs ----

enum
{
    FRAMES = 100,
};

typedef enum flaw
{
    SOUND,
    RECOVERS,     // from a strain, in frame 30
    LATE,         // the same in frame 80
    STAYS_LONG,   // does not
    NOT_A_NUMBER, // in frame 40 alone
    NOT_A_STRAIN, // the same, of the strain
    GAINS,        // energy in one frame
    TREMBLES,     // in the last frames
    COMPARISONS,  // for one frame
    HALTED,
    CROSSES, // for one frame
} flaw;

static wisp_status fake_step( void* context, int frame, wisp_error* error )
{
    (void)context;
    (void)frame;
    (void)error;
    return WISP_OK;
}

static wisp_status fake_observe( void* context, int frame, stability_observation* out, wisp_error* error )
{
    (void)error;
    const flaw kind = *(const flaw*)context;
    *out = ( stability_observation ){
        .is_finite = true, .strain_limit = 0.1, .strain = 0.05, .energy = 2.0, .speed = 0.001
    };
    const bool is_long = ( kind == RECOVERS && frame < 30 ) || ( kind == LATE && frame < 80 ) || kind == STAYS_LONG;
    out->strain = is_long ? 0.5 : out->strain;
    out->is_finite = !( kind == NOT_A_NUMBER && frame == 40 );
    out->strain = kind == NOT_A_STRAIN && frame == 40 ? NAN : out->strain;
    out->energy += kind == GAINS && frame == 40 ? 1.0 : 0.0;
    out->speed = kind == TREMBLES && frame > 95 ? 0.5 : kind == COMPARISONS && frame == 40 ? 1e3 : out->speed;
    out->is_halted = kind == HALTED && frame >= 40;
    out->breach = kind == CROSSES && frame == 40 ? 1.0 : 0.0;
    return WISP_OK;
}

static uint64_t fake_hash( void* context )
{
    return ( uint64_t ) * (const flaw*)context;
}

static void fake_close( void* context )
{
    (void)context;
}

static stability_outcome run_fake( flaw kind, bool may_halt )
{
    stability_trial trial = {
        .limits = { .strain = INFINITY,
                    .energy = 0.5,
                    .jitter = 0.01,
                    .breach = 0.0,
                    .recovery_frames = 60,
                    .still_frames = 10,
                    .speed = 100.0,
                    .may_halt = may_halt },
        .frame_count = FRAMES,
        .context = &kind,
        .step = fake_step,
        .observe = fake_observe,
        .hash = fake_hash,
        .close = fake_close,
    };
    stability_outcome out;
    wisp_error error = { 0 };
    assert_int_equal( stability_run( &trial, &out, &error ), WISP_OK );
    assert_int_equal( out.score.frames, FRAMES );
    return out;
}

static void what_is_sound_holds( void** state )
{
    (void)state;
    const stability_outcome out = run_fake( SOUND, false );
    assert_int_equal( out.verdict.broke, STABILITY_LIMIT_NONE );
    assert_int_equal( out.verdict.frames, 0 );
}

static void what_recovers_says_in_how_many_frames( void** state )
{
    (void)state;
    const stability_outcome out = run_fake( RECOVERS, false );
    assert_int_equal( out.verdict.broke, STABILITY_LIMIT_NONE );
    assert_int_equal( out.verdict.frames, 29 );
}

static void every_flaw_breaks_the_limit_that_it_should( void** state )
{
    (void)state;
    static const stability_limit expected[] = {
        [LATE] = STABILITY_LIMIT_RECOVERY,       [STAYS_LONG] = STABILITY_LIMIT_STRAIN,
        [NOT_A_NUMBER] = STABILITY_LIMIT_FINITE, [NOT_A_STRAIN] = STABILITY_LIMIT_FINITE,
        [GAINS] = STABILITY_LIMIT_ENERGY,        [TREMBLES] = STABILITY_LIMIT_JITTER,
        [COMPARISONS] = STABILITY_LIMIT_SPEED,   [HALTED] = STABILITY_LIMIT_HALTED,
        [CROSSES] = STABILITY_LIMIT_BREACH,
    };
    for ( int kind = LATE; kind <= CROSSES; ++kind )
    {
        const stability_outcome out = run_fake( (flaw)kind, false );
        assert_string_equal( stability_limit_names[out.verdict.broke], stability_limit_names[expected[kind]] );
    }
}

static void to_halt_is_right_only_where_it_is_expected( void** state )
{
    (void)state;
    assert_int_equal( run_fake( HALTED, true ).verdict.broke, STABILITY_LIMIT_NONE );
    assert_int_equal( run_fake( HALTED, false ).verdict.broke, STABILITY_LIMIT_HALTED );
}

static void a_cell_that_is_listed_must_break_as_the_list_says_and_no_other_may( void** state )
{
    (void)state;
    static const stability_known list[] = { { "a", STABILITY_LIMIT_ENERGY } };
    const stability_known* known = stability_find_known( list, 1, "a" );
    assert_ptr_equal( known, list );
    assert_null( stability_find_known( list, 1, "b" ) );
    assert_true( stability_is_as_known( known, STABILITY_LIMIT_ENERGY ) );
    assert_false( stability_is_as_known( known, STABILITY_LIMIT_NONE ) ); // the limit is gone
    assert_false( stability_is_as_known( known, STABILITY_LIMIT_FINITE ) );
    assert_true( stability_is_as_known( NULL, STABILITY_LIMIT_NONE ) );
    assert_false( stability_is_as_known( NULL, STABILITY_LIMIT_JITTER ) );
}

// ---- the matrix ----

static void no_two_cells_have_one_name_and_every_start_has_its_twin( void** state )
{
    (void)state;
    int subjects;
    const stability_subject* subject = stability_cloths( &subjects );
    for ( int s = 0; s < subjects; ++s )
    {
        stability_cell* cells;
        const int count = stability_matrix( subject + s, false, &cells );
        assert_true( count > 1 );
        for ( int i = 0; i < count; ++i )
        {
            assert_true( cells[i].axes.start == STABILITY_START_REST || stability_twin( cells, i ) >= 0 );
            for ( int k = 0; k < i; ++k )
            {
                assert_string_not_equal( cells[i].name, cells[k].name );
            }
        }
        free( cells );
    }
}

static bool is_cell( const stability_subject* subjects, int count, const char* name )
{
    bool found = false;
    for ( int s = 0; s < count; ++s )
    {
        stability_cell* cells;
        const int cell_count = stability_matrix( subjects + s, false, &cells );
        for ( int i = 0; i < cell_count; ++i )
        {
            found = found || strcmp( cells[i].name, name ) == 0;
        }
        free( cells );
    }
    return found;
}

static bool is_named( const stability_named* list, int count, const char* name )
{
    bool found = false;
    for ( int i = 0; i < count; ++i )
    {
        found = found || strcmp( list[i].name, name ) == 0;
    }
    return found;
}

static void every_line_of_the_list_is_a_cell( void** state )
{
    (void)state;
    int known, counts[7];
    const stability_known* list = stability_known_limits( &known );
    const stability_subject* subjects[3] = { stability_cloths( counts ), stability_balloons( counts + 1 ),
                                             stability_strand_subjects( counts + 2 ) };
    const stability_named* named[4] = { stability_drives( counts + 3 ), stability_meshes( counts + 4 ),
                                        stability_failures( counts + 5 ), stability_followers( counts + 6 ) };
    for ( int i = 0; i < known; ++i )
    {
        bool found = false;
        for ( int k = 0; k < 4; ++k )
        {
            found = found || is_named( named[k], counts[k + 3], list[i].cell ) ||
                    ( k < 3 && is_cell( subjects[k], counts[k], list[i].cell ) );
        }
        if ( found == false )
        {
            fail_msg( "'%s' is listed and no cell", list[i].cell );
        }
    }
}

// ---- the cells themselves ----

static void every_quick_cell_holds_or_breaks_as_the_list_says( void** state )
{
    (void)state;
    const bench_options quick = { .quick = true, .workers = 2 };
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( stability_bench( &quick, &all, &error ), error );
    for ( int i = 0; i < all.note_count && all.failed; ++i )
    {
        print_message( "%s\n", all.notes[i] );
    }
    const bool failed = all.failed;
    assert_true( all.row_count > 50 );
    results_free( &all );
    assert_false( failed );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( what_is_sound_holds ),
        cmocka_unit_test( what_recovers_says_in_how_many_frames ),
        cmocka_unit_test( every_flaw_breaks_the_limit_that_it_should ),
        cmocka_unit_test( to_halt_is_right_only_where_it_is_expected ),
        cmocka_unit_test( a_cell_that_is_listed_must_break_as_the_list_says_and_no_other_may ),
        cmocka_unit_test( no_two_cells_have_one_name_and_every_start_has_its_twin ),
        cmocka_unit_test( every_line_of_the_list_is_a_cell ),
        cmocka_unit_test( every_quick_cell_holds_or_breaks_as_the_list_says ),
    };
    return cmocka_run_group_tests_name( "bench stability", tests, NULL, NULL );
}
