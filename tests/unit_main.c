// The main() of all programs of tests: the cases that registered themselves before it, as one group of cmocka. Of a program of several
// files the argument is the name of one, whose cases run alone.
#include "unit.h"

enum
{
    EXIT_SKIPPED = 77, // what meson counts as skipped
    EXIT_USAGE = 64,
};

static unit_case* first;
static int case_count;
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

void unit_set_arguments( unit_arguments_fn* take )
{
    take_arguments = take;
}

void unit_set_obstacle( unit_obstacle_fn* find )
{
    find_obstacle = find;
}

// @param name without folder and ending
static bool is_named( const char* file, const char* name )
{
    const char* slash = strrchr( file, '/' );
    const size_t length = strlen( name );
    file = slash != NULL ? slash + 1 : file;
    return strncmp( file, name, length ) == 0 && strcmp( file + length, ".c" ) == 0;
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
    const char* chosen = take_arguments == NULL && argc > 1 ? argv[1] : NULL;
    struct CMUnitTest tests[case_count + 1], fixture = { .name = NULL };
    int count = 0;
    bool is_one = true;
    for ( const unit_case* c = first; c != NULL; c = c->next )
    {
        const bool is_chosen = chosen == NULL || is_named( c->file, chosen );
        is_one = is_one && ( chosen != NULL || strcmp( c->file, first->file ) == 0 );
        if ( is_chosen )
        {
            struct CMUnitTest* to = c->test.test_func != NULL ? tests + count++ : &fixture;
            *to = c->test;
        }
    }
    if ( count == 0 || is_one == false )
    {
        print_error( "%s has %s: give the name of a file, such as test_cloth\n", argv[0],
                     count == 0 ? "no such case" : "the cases of several files" );
        return EXIT_USAGE;
    }
    struct CMUnitTest( *all )[count] = (void*)tests;
    const char* slash = strrchr( argv[0], '/' );
    const char* name = chosen != NULL ? chosen : slash != NULL ? slash + 1 : argv[0];
    // A count of failures as status could be the one of a skipped program.
    const int failed = cmocka_run_group_tests_name( name, *all, fixture.setup_func, fixture.teardown_func );
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
