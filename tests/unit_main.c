// The main() of all programs of tests: the cases that registered themselves before it, as one group of cmocka.
#include "unit.h"

enum
{
    EXIT_SKIPPED = 77, // what meson counts as skipped
    EXIT_USAGE = 64,
};

static unit_case* first;
static int case_count;
static CMFixtureFunction group_set_up, group_tear_down;
static unit_arguments_fn* take_arguments;
static unit_obstacle_fn* find_obstacle;

// Constructors run in any order, so a case is put behind those of its file that are defined above it.
void unit_add_case( unit_case* added )
{
    unit_case** at = &first;
    while ( *at != NULL && ( strcmp( ( *at )->file, added->file ) != 0 || ( *at )->place < added->place ) )
    {
        at = &( *at )->next;
    }
    added->next = *at;
    *at = added;
    ++case_count;
}

void unit_set_group( CMFixtureFunction set_up, CMFixtureFunction tear_down )
{
    group_set_up = set_up;
    group_tear_down = tear_down;
}

void unit_set_arguments( unit_arguments_fn* take )
{
    take_arguments = take;
}

void unit_set_obstacle( unit_obstacle_fn* find )
{
    find_obstacle = find;
}

int main( int argc, char** argv )
{
    if ( take_arguments != NULL && take_arguments( argc, argv ) == false )
    {
        return EXIT_USAGE;
    }
    const char* obstacle = find_obstacle != NULL ? find_obstacle() : NULL;
    if ( obstacle != NULL )
    {
        print_message( "skipped: %s\n", obstacle );
        return EXIT_SKIPPED;
    }
    if ( case_count == 0 )
    {
        print_error( "%s has no case\n", argv[0] );
        return EXIT_FAILURE;
    }
    struct CMUnitTest tests[case_count];
    int count = 0;
    for ( const unit_case* c = first; c != NULL; c = c->next )
    {
        tests[count++] = c->test;
    }
    const char* slash = strrchr( argv[0], '/' );
    // A count of failures as status could be the one of a skipped program.
    const int failed =
        cmocka_run_group_tests_name( slash != NULL ? slash + 1 : argv[0], tests, group_set_up, group_tear_down );
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
