// The main() of all programs of tests: the cases that registered themselves before it, as one group of cmocka. Of a program of several
// files the argument is the name of one, whose cases run alone.
#include "unit.h"

enum
{
    EXIT_SKIPPED = 77, // what meson counts as skipped
    EXIT_USAGE = 64,
};

static unit_case* first;
static unit_group* first_group;
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
}

void unit_add_group( unit_group* added )
{
    added->next = first_group;
    first_group = added;
}

void unit_set_arguments( unit_arguments_fn* take )
{
    take_arguments = take;
}

void unit_set_obstacle( unit_obstacle_fn* find )
{
    find_obstacle = find;
}

// @param name of a file, without folder and ending; NULL: all files
static bool is_chosen( const char* file, const char* name )
{
    const char* slash = strrchr( file, '/' );
    const char* own = slash != NULL ? slash + 1 : file;
    return name == NULL || ( strncmp( own, name, strlen( name ) ) == 0 && strcmp( own + strlen( name ), ".c" ) == 0 );
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
    int count = 0;
    for ( const unit_case* c = first; c != NULL; c = c->next )
    {
        count += is_chosen( c->file, chosen ) ? 1 : 0;
        if ( chosen == NULL && strcmp( c->file, first->file ) != 0 )
        {
            print_error( "%s has the cases of several files: give the name of one, such as test_cloth\n", argv[0] );
            return EXIT_USAGE;
        }
    }
    if ( count == 0 )
    {
        print_error( "%s has no case%s%s\n", argv[0], chosen != NULL ? " of " : "", chosen != NULL ? chosen : "" );
        return EXIT_FAILURE;
    }
    struct CMUnitTest tests[count];
    count = 0;
    for ( const unit_case* c = first; c != NULL; c = c->next )
    {
        if ( is_chosen( c->file, chosen ) )
        {
            tests[count++] = c->test;
        }
    }
    const unit_group none = { .file = "" }, *group = first_group;
    while ( group != NULL && is_chosen( group->file, chosen ) == false )
    {
        group = group->next;
    }
    group = group != NULL ? group : &none;
    const char* slash = strrchr( argv[0], '/' );
    const char* name = chosen != NULL ? chosen : slash != NULL ? slash + 1 : argv[0];
    // A count of failures as status could be the one of a skipped program.
    const int failed = cmocka_run_group_tests_name( name, tests, group->set_up, group->tear_down );
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
