#include "torture_search.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// ---- smaller scenes ----

typedef struct shrinker
{
    const torture_shrink_def* def;
    text_node* scene;
    int tries;
    double end;
} shrinker;

static bool has_time( const shrinker* s )
{
    return s->tries < s->def->max_tries && wisp_clock_seconds() < s->end;
}

static bool shows( shrinker* s )
{
    ++s->tries;
    return s->def->shows( s->def->user, s->scene );
}

// ---- parts that go ----

// Put a child back where it was.
static void insert( text_node* parent, int place, text_node* child )
{
    text_add( parent, child );
    for ( int i = parent->count - 1; i > place; --i )
    {
        parent->children[i] = parent->children[i - 1];
    }
    parent->children[place] = child;
}

static bool try_without( shrinker* s, text_node* parent, int place )
{
    text_node* child = parent->children[place];
    --parent->count;
    memmove( parent->children + place, parent->children + place + 1,
             (size_t)( parent->count - place ) * sizeof *parent->children );
    if ( shows( s ) )
    {
        text_release( child );
        return true;
    }
    insert( parent, place, child );
    return false;
}

// Outer parts first: an entry that goes takes all of its keys with it. Later ones may name earlier ones, so they go
// first.
static bool take_out( shrinker* s, text_node* node )
{
    bool has_changed = false;
    for ( int i = node->count - 1; i >= 0 && has_time( s ); --i )
    {
        const bool is_vector = node->kind == TEXT_LIST && text_is_number( node->children[i], NULL );
        has_changed |= !is_vector && try_without( s, node, i );
    }
    for ( int i = node->count - 1; i >= 0 && has_time( s ); --i )
    {
        has_changed |= take_out( s, node->children[i] );
    }
    return has_changed;
}

// ---- numbers that get simpler ----

static bool is_simpler( const char* text, const char* than )
{
    double a = strtod( text, NULL ), b = strtod( than, NULL );
    const bool are_whole =
        strspn( text, "0123456789" ) == strlen( text ) && strspn( than, "0123456789" ) == strlen( than );
    return are_whole
               ? a < b
               : strlen( text ) < strlen( than ) || ( strlen( text ) == strlen( than ) && fabs( a ) < fabs( b ) );
}

static bool try_text( shrinker* s, text_node* scalar, const char* text )
{
    if ( !has_time( s ) || !is_simpler( text, scalar->text ) )
    {
        return false;
    }
    char before[64];
    snprintf( before, sizeof before, "%s", scalar->text );
    text_set( scalar, text );
    if ( shows( s ) )
    {
        return true;
    }
    text_set( scalar, before );
    return false;
}

// Nothing, one digit, two digits; of a whole number also its half and the one below.
static bool simplify_number( shrinker* s, text_node* scalar, double value )
{
    char candidates[5][64];
    const bool is_whole = value >= 2.0 && value == floor( value ) && value < 1e9;
    int count = 0;
    snprintf( candidates[count++], sizeof candidates[0], "0" );
    if ( is_whole )
    {
        snprintf( candidates[count++], sizeof candidates[0], "%.0f", floor( value / 2.0 ) );
        snprintf( candidates[count++], sizeof candidates[0], "%.0f", value - 1.0 );
    }
    else
    {
        snprintf( candidates[count++], sizeof candidates[0], "%.1g", value );
        snprintf( candidates[count++], sizeof candidates[0], "%.2g", value );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( try_text( s, scalar, candidates[i] ) )
        {
            return true;
        }
    }
    return false;
}

static bool simplify( shrinker* s, text_node* node )
{
    double value;
    if ( text_is_number( node, &value ) && strlen( node->text ) < 60 )
    {
        return simplify_number( s, node, value );
    }
    bool has_changed = false;
    for ( int i = 0; i < node->count && has_time( s ); ++i )
    {
        has_changed |= simplify( s, node->children[i] );
    }
    return has_changed;
}

int torture_shrink( const torture_shrink_def* def, text_node* scene )
{
    shrinker s = { def, scene, 0, wisp_clock_seconds() + def->max_seconds };
    for ( bool has_changed = true; has_changed && has_time( &s ); )
    {
        has_changed = take_out( &s, scene );
        has_changed |= simplify( &s, scene );
    }
    return s.tries;
}

// ---- what was found ----

enum
{
    MAX_JOBS = 64,
};

int torture_broken_count( const torture_found* found )
{
    int sum = 0;
    for ( int i = 0; i < STABILITY_CHECK_COUNT; ++i )
    {
        sum += found->broken[i];
    }
    return sum;
}

// ---- making it smaller ----

typedef struct shown
{
    const torture_search* search;
    const char* name;
    stability_check check;
    double severity; // that must not be lost: a scene that breaks by a hair is another one
    int twins;
    stability_verdict verdict; // of the last scene that shows it
} shown;

// The reader must take the scene: a scene that it refuses is another failure.
static bool breaks_the_same( void* user, const text_node* scene )
{
    shown* s = user;
    const torture_subject subject = { scene, s->name };
    wisp_scene read;
    const wisp_status status = torture_read( &subject, &read, NULL );
    wisp_scene_release( &read );
    if ( status != WISP_OK || interruption_came() )
    {
        return false;
    }
    const stability_verdict verdict = torture_judge_scene( &subject, s->twins, s->search->scene_seconds );
    const bool is_same = !interruption_came() && verdict.check == s->check && verdict.severity >= s->severity;
    s->verdict = is_same ? verdict : s->verdict;
    return is_same;
}

// Only the twins that broke need to run again.
static int twins_of( stability_check judge )
{
    switch ( judge )
    {
        case STABILITY_BITS:
            return TORTURE_TWIN_BITS;
        case STABILITY_SNAPSHOT:
            return TORTURE_TWIN_SNAPSHOT;
        case STABILITY_SCALE:
            return TORTURE_TWIN_SCALE;
        case STABILITY_SHIFT:
            return TORTURE_TWIN_SHIFT;
        default:
            return 0;
    }
}

// ---- files ----

// The file is in the folder: the paths of meshes are from there.
static void name_of( const torture_search* search, char* name, size_t size, stability_check judge, int number )
{
    snprintf( name, size, "%s/%s_%llu_%d.yaml", search->folder, stability_check_names[judge],
              (unsigned long long)search->generator.seed, number );
}

static wisp_status write_scene( const char* path, const text_node* scene, const char* comment, wisp_error* error )
{
    char* text = text_write( scene, comment );
    const wisp_status status = io_file_write( path, text, strlen( text ), error );
    free( text );
    return status;
}

static wisp_status keep_scene( const torture_search* search, text_node* scene, const stability_verdict* verdict,
                               const char* name, int number, results* out, wisp_error* error )
{
    const int MAX_TRIES = 600;
    const double MAX_SECONDS = 120.0, CLEAR = 3.0;
    shown s = {
        search,  name, verdict->check, fmin( verdict->severity, CLEAR ), twins_of( verdict->check ) | search->close,
        *verdict
    };
    const torture_shrink_def shrink = { breaks_the_same, &s, MAX_TRIES, MAX_SECONDS };
    char comment[512], path[4096];
    torture_shrink( &shrink, scene );
    snprintf( comment, sizeof comment, "%s: %s (seed %llu, scene %d).", stability_check_names[verdict->check],
              s.verdict.message, (unsigned long long)search->generator.seed, number );
    name_of( search, path, sizeof path, verdict->check, number );
    results_add_note( out, "%s: %s", path, s.verdict.message );
    return write_scene( path, scene, comment, error );
}

// ---- the search ----

// Each scene has one twin, in turn: all of them would take five times as long.
int torture_twins_for( int number )
{
    static const int TURNS[] = { TORTURE_TWIN_BITS, TORTURE_TWIN_SCALE, TORTURE_TWIN_SNAPSHOT, TORTURE_TWIN_SHIFT };
    return TURNS[number % WISP_COUNT( TURNS )];
}

// Scenes that are judged at the same time, in turn.
typedef struct pending
{
    text_node* scene;
    torture_child child;
    int number;
} pending;

static void subject_name( const torture_search* search, char* name, size_t size )
{
    snprintf( name, size, "%s/scene", search->folder );
}

static pending start_scene( const torture_search* search, int number )
{
    char name[4096];
    pending p = { .scene = torture_generate( &search->generator, number ), .number = number };
    subject_name( search, name, sizeof name );
    const torture_subject subject = { p.scene, name };
    p.child = torture_start( &subject, torture_twins_for( number ) | search->close, search->scene_seconds );
    return p;
}

static wisp_status finish_scene( const torture_search* search, const pending* p, torture_found* found, results* out,
                                 wisp_error* error )
{
    char name[4096];
    subject_name( search, name, sizeof name );
    const stability_verdict verdict = torture_finish( &p->child );
    wisp_status status = WISP_OK;
    if ( interruption_came() ) // the verdict is that of a process that was stopped
    {
        text_release( p->scene );
        return WISP_OK;
    }
    ++found->scenes;
    found->refused += verdict.check == STABILITY_REFUSED;
    if ( verdict.check != STABILITY_HOLDS && verdict.check != STABILITY_REFUSED )
    {
        const bool is_kept = found->broken[verdict.check]++ < search->keep;
        results_add_note( out, "scene %d: %s: %s", p->number, stability_check_names[verdict.check], verdict.message );
        status = is_kept ? keep_scene( search, p->scene, &verdict, name, p->number, out, error ) : WISP_OK;
    }
    text_release( p->scene );
    return status;
}

static void report( const torture_found* found, results* out )
{
    const double per_second = found->scenes / fmax( found->seconds, 1e-9 );
    out->machine = machine_describe( "every set" );
    const int table = results_begin_table( out, "", "\t" );
    if ( interruption_came() )
    {
        results_add_line( out, table, "interrupted\tafter %d scenes", found->scenes );
    }
    results_row* row = results_add_row( out, "torture", "search" );
    results_add_line( out, table, "scenes\t%d, %.3g per second", found->scenes, per_second );
    results_put( &row->size, "scenes", found->scenes );
    results_put( &row->size, "scenes_per_second", per_second );
    if ( found->refused > 0 )
    {
        results_add_line( out, table, "refused\t%d", found->refused );
    }
    results_put( &row->size, "refused", found->refused );
    results_add_line( out, table, "broken\t%d", torture_broken_count( found ) );
    for ( int i = 0; i < STABILITY_CHECK_COUNT; ++i )
    {
        if ( found->broken[i] > 0 )
        {
            results_add_line( out, table, "%s\t%d", stability_check_names[i], found->broken[i] );
        }
        results_put( &row->size, stability_check_names[i], found->broken[i] );
    }
}

wisp_status torture_search_run( const torture_search* search, torture_found* found, results* out, wisp_error* error )
{
    *found = ( torture_found ){ 0 };
    const double start = wisp_clock_seconds();
    if ( mkdir( search->folder, 0777 ) != 0 && errno != EEXIST )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", search->folder, strerror( errno ) );
    }
    progress bar = progress_begin();
    const int jobs = search->jobs < MAX_JOBS ? search->jobs : MAX_JOBS;
    pending ring[MAX_JOBS];
    wisp_status status = WISP_OK;
    int started = 0, finished = 0;
    for ( bool goes_on = true; goes_on || finished < started; )
    {
        goes_on = status == WISP_OK && !interruption_came() &&
                  ( search->max_scenes == 0 || started < search->max_scenes ) && found->seconds < search->max_seconds;
        if ( goes_on && started - finished < jobs )
        {
            ring[started % jobs] = start_scene( search, search->first + started );
            ++started;
            continue;
        }
        if ( finished < started )
        {
            wisp_error later = { 0 };
            const wisp_status done =
                finish_scene( search, &ring[finished++ % jobs], found, out, status == WISP_OK ? error : &later );
            status = status == WISP_OK ? done : status;
        }
        found->seconds = wisp_clock_seconds() - start;
        progress_show( &bar,
                       search->max_scenes > 0 ? (double)finished / search->max_scenes
                                              : found->seconds / search->max_seconds,
                       "scenes" );
    }
    progress_end( &bar );
    report( found, out );
    return status;
}

// ---- files that are given ----

static wisp_status read_tree( const char* path, text_node** out, wisp_error* error )
{
    const size_t MAX_BYTES = (size_t)16 << 20;
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    *out = NULL;
    status = status == WISP_OK ? text_parse( bytes ? (const char*)bytes : "", size, path, out, error ) : status;
    free( bytes );
    return status;
}

wisp_status torture_replay( const char* const* files, int count, int close, double scene_seconds,
                            torture_found* found, results* out, wisp_error* error )
{
    *found = ( torture_found ){ 0 };
    const double start = wisp_clock_seconds();
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK && !interruption_came(); ++i )
    {
        text_node* tree;
        wisp_scene scene = { 0 };
        status = read_tree( files[i], &tree, error );
        const torture_subject subject = { tree, files[i] };
        status = status == WISP_OK ? torture_read( &subject, &scene, error ) : status;
        if ( status == WISP_OK )
        {
            const stability_verdict verdict =
                torture_judge_scene( &subject, TORTURE_TWIN_ALL | close, scene_seconds );
            found->scenes += interruption_came() ? 0 : 1;
            if ( verdict.check != STABILITY_HOLDS && !interruption_came() )
            {
                ++found->broken[verdict.check];
                results_add_note( out, "%s: %s: %s", files[i], stability_check_names[verdict.check],
                                  verdict.message );
            }
        }
        wisp_scene_release( &scene );
        text_release( tree );
    }
    found->seconds = wisp_clock_seconds() - start;
    report( found, out );
    return status;
}
