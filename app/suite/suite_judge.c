#include "suite_judge.h"

#include "nearest.h"
#include "stability_judges.h"
#include "suite_measure.h"
#include "suite_reader.h"
#include "text_tree.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- what must be true of rows, and which of them are known to break it ----

// What must be true of rows, and which of them are known to break it.

// Those that a run of a scene can break; the rest is of the search for scenes that do.
static const stability_check check_words[] = { STABILITY_STATUS, STABILITY_FINITE,      STABILITY_HALTED,
                                               STABILITY_ENERGY, STABILITY_STRAIN,      STABILITY_RECOVERY,
                                               STABILITY_SPEED,  STABILITY_PENETRATION, STABILITY_INTERSECTIONS,
                                               STABILITY_REST,   STABILITY_BITS,        STABILITY_NEAR,
                                               STABILITY_SAME };
enum
{
    PLAIN_CHECKS = WISP_COUNT( check_words ) - 2, // the last ones need to be told what
};

static wisp_status read_word( const suite_reader* r, const text_node* node, int* out )
{
    const char* names[WISP_COUNT( check_words )];
    char all[160] = "";
    const char* text = text_value( node );
    for ( int i = 0; i < WISP_COUNT( check_words ); ++i )
    {
        names[i] = stability_check_names[check_words[i]];
        strncat( all, i > 0 ? ", " : "", sizeof all - strlen( all ) - 1 );
        strncat( all, names[i], sizeof all - strlen( all ) - 1 );
        if ( strcmp( text, names[i] ) == 0 )
        {
            *out = check_words[i];
            return WISP_OK;
        }
    }
    const scene_quote quote = scene_shorten( text );
    const char* nearest = nearest_word( quote.text, names, WISP_COUNT( check_words ) );
    return nearest ? suite_refuse( r, node, "got check '%s'; did you mean '%s'?", quote.text, nearest )
                   : suite_refuse( r, node, "got check '%s', expected one of %s", quote.text, all );
}

static bool is_all( const text_node* node )
{
    return node->kind == TEXT_SCALAR && strcmp( text_value( node ), "all" ) == 0;
}

static unsigned all_checks( void )
{
    unsigned all = 0;
    for ( int i = 0; i < PLAIN_CHECKS; ++i )
    {
        all |= stability_bit( check_words[i] );
    }
    return all;
}

static double number_in( const text_node* n, double otherwise )
{
    return n ? suite_number_of( n ) : otherwise;
}

// A measure and the value that it must come near.
static wisp_status read_near( const suite_reader* r, const text_node* block, stability_limits* limits )
{
    enum
    {
        OF,
        VALUE,
        WITHIN,
        AT,
        TAKE,
        FROM,
        NEAR_KEY_COUNT,
    };
    static const char* const keys[NEAR_KEY_COUNT] = { "of", "value", "within", "at", "take", "from" };
    const text_node* values[NEAR_KEY_COUNT];
    const char* text[NEAR_KEY_COUNT];
    WISP_TRY( suite_take_keys( r, block,
                               "a measure and its value, such as { of: rod.tip.y, value: -0.7, within: 0.02 }", keys,
                               NEAR_KEY_COUNT, values ) );
    for ( int i = 0; i < NEAR_KEY_COUNT; ++i )
    {
        text[i] = values[i] && values[i]->kind == TEXT_SCALAR ? text_value( values[i] ) : "";
    }
    stability_near near = { .within = number_in( values[WITHIN], NAN ),
                            .at = number_in( values[AT], 0.0 ),
                            .take = text[TAKE][0] ? STABILITY_TAKE_COUNT : STABILITY_TAKE_END };
    for ( int i = 0; i < STABILITY_TAKE_COUNT; ++i )
    {
        near.take = strcmp( text[TAKE], stability_near_takes[i] ) == 0 ? (stability_take)i : near.take;
    }
    snprintf( near.from, sizeof near.from, "%s", text[FROM] );
    const bool is_vector = values[VALUE] && values[VALUE]->kind == TEXT_LIST && values[VALUE]->count == 3;
    if ( near.take == STABILITY_TAKE_COUNT )
    {
        return suite_refuse( r, values[TAKE], "got '%s', expected one of end, mean, min, max, period, change",
                             scene_shorten( text[TAKE] ).text );
    }
    const text_node* value = is_vector ? text_first( values[VALUE] ) : values[VALUE];
    for ( int axis = 0; axis < ( is_vector ? 3 : 1 ); ++axis )
    {
        char of[sizeof near.of];
        snprintf( of, sizeof of, is_vector ? "%.90s.%c" : "%.95s", text[OF], 'x' + axis );
        if ( !stability_near_parse( of, &near ) )
        {
            return suite_refuse( r, values[OF] ? values[OF] : block,
                                 "got '%s', expected a body and a measure, such as rod.tip.y or ball.pressure: of %s",
                                 scene_shorten( text[OF] ).text, stability_near_words() );
        }
        near.value = number_in( value, NAN );
        if ( !isfinite( near.value ) || !( near.within > 0.0 ) || !isfinite( near.within ) || !( near.at >= 0.0 ) )
        {
            return suite_refuse( r, block,
                                 "expected a value, `within` above 0 and, if there is one, `at` of at least 0" );
        }
        if ( limits->near_count == STABILITY_MAX_NEAR )
        {
            return suite_refuse( r, block, "expected at most %d values of a row", STABILITY_MAX_NEAR );
        }
        limits->near[limits->near_count++] = near;
        value = is_vector ? value->next : value;
    }
    return WISP_OK;
}

// Checks that are told what: near, same.
static bool read_told( const suite_reader* r, const text_node* map, int* out, stability_limits* limits,
                       wisp_status* status )
{
    const text_node* n = text_first( map );
    const char* key = map->count == 1 ? n->key : "";
    const bool is_near = strcmp( key, stability_check_names[STABILITY_NEAR] ) == 0;
    if ( !is_near && strcmp( key, stability_check_names[STABILITY_SAME] ) != 0 )
    {
        return false;
    }
    const char* text = text_value( n );
    *out = is_near ? STABILITY_NEAR : STABILITY_SAME;
    if ( is_near )
    {
        *status = read_near( r, n, limits );
    }
    else if ( text[0] == '\0' || strlen( text ) >= sizeof limits->same )
    {
        *status = suite_refuse( r, n, "expected the name of a row" );
    }
    else
    {
        strcpy( limits->same, text );
    }
    return true;
}

// A check and its limit, such as { strain: 0.1 }.
static wisp_status read_limit( const suite_reader* r, const text_node* map, int* out, stability_limits* limits )
{
    const text_node* n = text_first( map );
    wisp_status status = WISP_OK;
    if ( read_told( r, map, out, limits, &status ) )
    {
        return status;
    }
    const struct
    {
        stability_check check;
        double* limit;
    } all[] = { { STABILITY_STRAIN, &limits->strain },
                { STABILITY_ENERGY, &limits->energy },
                { STABILITY_SPEED, &limits->speed },
                { STABILITY_REST, &limits->rest } };
    for ( int i = 0; i < WISP_COUNT( all ) && map->count == 1; ++i )
    {
        if ( strcmp( n->key, stability_check_names[all[i].check] ) == 0 )
        {
            char* end = NULL;
            const char* text = text_value( n );
            *all[i].limit = strtod( text, &end );
            *out = all[i].check;
            return end != text && *end == '\0' && *all[i].limit > 0.0 && isfinite( *all[i].limit )
                       ? WISP_OK
                       : suite_refuse( r, n, "expected a limit above 0" );
        }
    }
    return suite_refuse( r, map,
                         "expected a check and its limit, one of strain, energy, speed, rest, near and same, such as "
                         "{ strain: 0.1 }" );
}

wisp_status suite_read_checks( const suite_reader* r, const text_node* node, unsigned* out, stability_limits* limits )
{
    *out = 0;
    *limits = ( stability_limits ){ 0 };
    if ( is_all( node ) )
    {
        *out = all_checks();
        return WISP_OK;
    }
    if ( node->kind != TEXT_LIST || node->count == 0 )
    {
        return suite_refuse( r, node,
                             "expected checks: all, or a list of checks such as [finite, energy, { strain: 0.1 }]" );
    }
    wisp_status status = WISP_OK;
    for ( const text_node* n = text_first( node ); n && status == WISP_OK; n = n->next )
    {
        int check = 0;
        if ( is_all( n ) )
        {
            *out |= all_checks();
            continue;
        }
        status = n->kind == TEXT_MAP ? read_limit( r, n, &check, limits ) : read_word( r, n, &check );
        if ( status == WISP_OK && n->kind == TEXT_SCALAR && ( check == STABILITY_NEAR || check == STABILITY_SAME ) )
        {
            return suite_refuse(
                r, n,
                "expected what, such as { near: { of: rod.tip.y, value: -0.7, within: 0.02 } } or { same: ROW }" );
        }
        *out |= stability_bit( (stability_check)check );
    }
    return status;
}

wisp_status suite_read_expect( const suite_reader* r, const text_node* node, bool* is_refused )
{
    *is_refused = node->kind == TEXT_SCALAR && strcmp( text_value( node ), "refused" ) == 0;
    return *is_refused ? WISP_OK : suite_refuse( r, node, "expected expect: refused" );
}

bool suite_error_grows( const char* along )
{
    const char* dot = strrchr( along, '.' );
    const char* field = dot != NULL ? dot + 1 : along;
    return strcmp( field, "dt" ) == 0 || strstr( field, "spacing" ) != NULL || strstr( field, "tolerance" ) != NULL;
}

void suite_label( const suite_row* row, char out[SUITE_MAX_LABEL] )
{
    snprintf( out, SUITE_MAX_LABEL, "%s%s%s", row->name, row->variant[0] ? ": " : "", row->variant );
}

// A label, or what varies alone.
static bool is_row_meant( const suite_row* row, const char* text )
{
    char label[SUITE_MAX_LABEL];
    suite_label( row, label );
    return strcmp( label, text ) == 0 || ( row->variant[0] && strcmp( row->variant, text ) == 0 );
}

static wisp_status mark_known( const suite_reader* r, const text_node* node )
{
    const char* text = node->key;
    int check = 0, count = 0;
    const wisp_status status = read_word( r, node, &check );
    for ( int i = 0; i < r->out->row_count && status == WISP_OK; ++i )
    {
        suite_row* row = &r->out->rows[i];
        if ( is_row_meant( row, text ) )
        {
            row->known = check;
            ++count;
            if ( ( row->checks & stability_bit( (stability_check)check ) ) == 0 )
            {
                return suite_refuse( r, node, "'%s' is known to break %s, which is none of its checks",
                                     scene_shorten( text ).text, stability_check_names[check] );
            }
        }
    }
    return status != WISP_OK || count > 0 ? status
                                          : scene_refuse( &r->source, node->key_line, node->key_column, "",
                                                          "no row is called '%s'", scene_shorten( text ).text );
}

// Find the rows that are to have the same bits.
static wisp_status find_same( const suite_reader* r )
{
    for ( int i = 0; i < r->out->row_count; ++i )
    {
        suite_row* row = &r->out->rows[i];
        for ( int k = 0; k < r->out->row_count && row->limits.same[0] && row->same == 0; ++k )
        {
            row->same = k != i && is_row_meant( &r->out->rows[k], row->limits.same ) ? k - i : 0;
        }
        if ( row->limits.same[0] && row->same == 0 )
        {
            return scene_refuse( &r->source, 0, 0, "", "%s: no other row is called '%s'", row->name,
                                 scene_shorten( row->limits.same ).text );
        }
    }
    return WISP_OK;
}

static wisp_status mark_list( const suite_reader* r, const text_node* list, bool is_long )
{
    if ( list->kind != TEXT_LIST )
    {
        return suite_refuse( r, list, "expected a list of rows" );
    }
    for ( int i = 0; i < r->out->row_count && !is_long; ++i )
    {
        r->out->rows[i].is_slow = true;
    }
    for ( const text_node* n = text_first( list ); n; n = n->next )
    {
        int count = 0;
        const char* text = text_value( n );
        for ( int i = 0; i < r->out->row_count; ++i )
        {
            suite_row* row = &r->out->rows[i];
            if ( is_row_meant( row, text ) )
            {
                row->is_long = row->is_long || is_long;
                row->is_slow = row->is_slow && is_long;
                ++count;
            }
        }
        if ( count == 0 )
        {
            return suite_refuse( r, n, "no row is called '%s'", scene_shorten( text ).text );
        }
    }
    return WISP_OK;
}

wisp_status suite_mark_rows( const suite_reader* r, const text_node* known, const text_node* quick,
                             const text_node* slow )
{
    WISP_TRY( find_same( r ) );
    if ( known && known->kind != TEXT_MAP )
    {
        return suite_refuse( r, known,
                             "expected rows and the checks that they break, such as { \"sheet\": strain }" );
    }
    for ( const text_node* n = known ? text_first( known ) : NULL; n; n = n->next )
    {
        WISP_TRY( mark_known( r, n ) );
    }
    WISP_TRY( quick ? mark_list( r, quick, false ) : WISP_OK );
    return slow ? mark_list( r, slow, true ) : WISP_OK;
}

// ---- a row is run and checked ----

// A row is run once for its trace, again from rest if it starts elsewhere, and again for its bits.

// ---- the same scene from rest ----

// A scaled rest shape stays what it is.
static void remove_starts( text_node* scene, const char* list )
{
    static const char* const keys[] = { "shape", "turns" };
    const text_node* bodies = text_find( scene, list );
    for ( int i = 0; bodies && i < bodies->count; ++i )
    {
        text_node* start = text_find( bodies->children[i], "start" );
        for ( int k = 0; start && k < WISP_COUNT( keys ); ++k )
        {
            text_remove_key( start, keys[k] );
        }
        if ( start && text_find( start, "shake" ) == NULL )
        {
            text_remove_key( start, "seed" );
        }
        if ( start && start->count == 0 )
        {
            text_remove_key( bodies->children[i], "start" );
        }
    }
}

// Rows that differ in their starts alone have the same key.
static uint64_t key_of( const suite_row* row )
{
    uint64_t key = SUITE_HASH_BEGIN ^ (uint64_t)row->steps;
    text_node* tree = NULL;
    if ( text_parse( row->text, strlen( row->text ), row->path, &tree, NULL ) == WISP_OK )
    {
        remove_starts( tree, "surfaces" );
        remove_starts( tree, "strands" );
        char* text = text_write( tree, NULL );
        key = text != NULL ? suite_hash_bytes( text, strlen( text ), key ) : key;
        free( text );
    }
    text_release( tree );
    return key;
}

static bool is_elsewhere( const wisp_scene_start* start )
{
    return start->shape != WISP_SCENE_START_REST ||
           start->file != NULL; // what is shaken a little may fall into other folds
}

static bool has_starts( const wisp_scene* scene )
{
    bool has = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        has = has || is_elsewhere( &scene->surfaces[i].start );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        has = has || is_elsewhere( &scene->strands[i].start );
    }
    return has;
}

static void put_to_rest( wisp_scene_start* start )
{
    start->shape = WISP_SCENE_START_REST;
    start->file = NULL;
}

static struct suite_twin* find( const suite_twins* twins, uint64_t key )
{
    for ( int i = 0; i < twins->count; ++i )
    {
        if ( twins->list[i].key == key )
        {
            return &twins->list[i];
        }
    }
    return NULL;
}

// Make room for one more item of a list.
static void* grow( void* list, int count, int* capacity, size_t size )
{
    if ( count < *capacity )
    {
        return list;
    }
    *capacity = *capacity > 0 ? 2 * *capacity : 16;
    void* larger = text_alloc( (size_t)*capacity * size );
    if ( count > 0 )
    {
        memcpy( larger, list, (size_t)count * size );
    }
    free( list );
    return larger;
}

static struct suite_twin* keep( suite_twins* twins, uint64_t key, const stability_trace* trace )
{
    twins->list = grow( twins->list, twins->count, &twins->capacity, sizeof *twins->list );
    struct suite_twin* twin = &twins->list[twins->count++];
    *twin =
        ( struct suite_twin ){ key, text_alloc( (size_t)trace->body_count * sizeof( double ) ), trace->body_count };
    for ( int body = 0; body < trace->body_count; ++body )
    {
        twin->strains[body] = stability_sample_of( trace, trace->steps, body )->strain;
    }
    return twin;
}

void suite_twins_release( suite_twins* twins )
{
    for ( int i = 0; i < twins->count; ++i )
    {
        free( twins->list[i].strains );
    }
    free( twins->list );
    free( twins->hashes );
    *twins = ( suite_twins ){ 0 };
}

static struct suite_twin* run_twin( const suite_row* row, uint64_t key, suite_twins* twins )
{
    wisp_scene scene;
    stability_trace trace;
    struct suite_twin* twin = NULL;
    if ( suite_scene( row, &scene, NULL ) != WISP_OK )
    {
        return NULL;
    }
    for ( int i = 0; i < scene.surface_count; ++i )
    {
        put_to_rest( &scene.surfaces[i].start );
    }
    for ( int i = 0; i < scene.strands_count; ++i )
    {
        put_to_rest( &scene.strands[i].start );
    }
    if ( stability_trace_run( &scene, NULL, &trace, NULL ) == WISP_OK )
    {
        twin = keep( twins, key, &trace );
    }
    stability_trace_release( &trace );
    wisp_scene_release( &scene );
    return twin;
}

// What starts elsewhere must reach about the state of the same scene from rest: twice its strain, or 1 %.
static void limit_strain( const suite_row* row, const wisp_scene* scene, suite_twins* twins, stability_trace* trace )
{
    const double FACTOR = 2.0, LEAST = 0.01;
    const uint64_t key = key_of( row );
    const struct suite_twin* twin = find( twins, key );
    if ( !has_starts( scene ) )
    {
        twin = twin ? twin : keep( twins, key, trace );
        return;
    }
    twin = twin ? twin : run_twin( row, key, twins );
    for ( int body = 0; twin && body < trace->body_count; ++body )
    {
        trace->bodies[body].twin = fmax( FACTOR * twin->strains[body], LEAST );
    }
}

// ---- a row ----

static void count_as_refused( const suite_row* row, const char* message, suite_outcome* out )
{
    out->is_refused = true;
    out->verdict.check = row->is_refused ? STABILITY_HOLDS : STABILITY_REFUSED;
    snprintf( out->verdict.message, sizeof out->verdict.message, "%.310s", message );
}

static void keep_hash( const suite_row* row, uint64_t hash, suite_twins* twins )
{
    twins->hashes = grow( twins->hashes, twins->hash_count, &twins->hash_capacity, sizeof *twins->hashes );
    twins->hashes[twins->hash_count++] = ( struct suite_hash ){ row, hash };
}

// The hash of a row that has run, or runs now.
static uint64_t hash_of( const suite_row* row, suite_twins* twins )
{
    for ( int i = 0; i < twins->hash_count; ++i )
    {
        if ( twins->hashes[i].row == row )
        {
            return twins->hashes[i].hash;
        }
    }
    wisp_scene scene;
    stability_trace trace = { .hash = 0 };
    if ( suite_scene( row, &scene, NULL ) == WISP_OK )
    {
        (void)stability_trace_run( &scene, NULL, &trace, NULL );
        stability_trace_release( &trace );
        wisp_scene_release( &scene );
    }
    keep_hash( row, trace.hash, twins );
    return trace.hash;
}

static bool judge_same( const suite_row* row, uint64_t hash, suite_twins* twins, stability_verdict* out )
{
    const uint64_t other = row->same != 0 ? hash_of( row + row->same, twins ) : hash;
    if ( other != hash )
    {
        *out = ( stability_verdict ){ .check = STABILITY_SAME, .severity = 1.0 };
        snprintf( out->message, sizeof out->message, "the points at the end have hash %016llx, those of '%s' %016llx",
                  (unsigned long long)hash, row->limits.same, (unsigned long long)other );
    }
    return other == hash;
}

static void judge_trace( const suite_row* row, const wisp_scene* scene, suite_twins* twins, stability_trace* trace,
                         suite_outcome* out )
{
    out->figures = stability_figures_of( trace, &row->limits );
    out->without_limit = stability_without_limit( &out->figures, row->checks );
    out->steps = trace->steps;
    out->hash = trace->hash;
    out->depth = trace->depth;
    out->resets = trace->resets;
    out->not_converged = trace->not_converged;
    out->degenerate = trace->degenerate;
    const bool holds = stability_judge_trace( trace, row->checks | STABILITY_CLOSE, &row->limits, &out->verdict );
    if ( row->is_refused )
    {
        out->verdict =
            ( stability_verdict ){ .check = STABILITY_REFUSED, .severity = 1.0, .message = "it is not refused" };
    }
    else if ( holds && judge_same( row, trace->hash, twins, &out->verdict ) &&
              ( row->checks & stability_bit( STABILITY_BITS ) ) )
    {
        stability_judge_bits( scene, scene->steps, &out->verdict );
    }
}

wisp_status suite_judge_row( const suite_row* row, suite_twins* twins, suite_outcome* out, wisp_error* error )
{
    *out = ( suite_outcome ){ .verdict = { .check = STABILITY_HOLDS } };
    if ( row->refusal[0] )
    {
        count_as_refused( row, row->refusal, out );
        return WISP_OK;
    }
    wisp_scene scene;
    wisp_error inner = { 0 };
    WISP_TRY( suite_scene( row, &scene, error ) );
    stability_trace trace;
    wisp_status status = stability_trace_run( &scene, &row->limits, &trace, &inner );
    if ( status == WISP_OK )
    {
        limit_strain( row, &scene, twins, &trace );
        keep_hash( row, trace.hash, twins );
        judge_trace( row, &scene, twins, &trace, out );
    }
    else if ( status == WISP_BAD_INPUT || status == WISP_CONFLICT )
    {
        count_as_refused( row, inner.message, out );
        status = WISP_OK;
    }
    else
    {
        wisp_fail( error, status, "%s", inner.message );
    }
    stability_trace_release( &trace );
    wisp_scene_release( &scene );
    return status;
}

bool suite_is_as_known( const suite_row* row, const suite_outcome* outcome )
{
    return row->known == (int)outcome->verdict.check;
}
