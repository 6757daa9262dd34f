// Entries of a suite, and the rows that they make.
#include "suite_reader.h"

#include "io_file.h"
#include "suite.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- fields ----

static text_node* value_of( const suite_reader* r, const text_node* node )
{
    if ( node->kind == TEXT_SCALAR )
    {
        return text_scalar( "%s", text_value( node ) );
    }
    text_node* out = node->kind == TEXT_LIST ? text_list() : text_map();
    for ( const text_node* n = text_first( node ); n; n = n->next )
    {
        if ( node->kind == TEXT_LIST )
        {
            text_add( out, value_of( r, n ) );
        }
        else
        {
            text_put( out, n->key, value_of( r, n ) );
        }
    }
    return out;
}

static wisp_status set_field( const suite_reader* r, text_node* scene, const text_node* field,
                              const text_node* value )
{
    const char* path = field->key;
    text_node* own = value_of( r, value );
    const int count = text_set_path( scene, path, own );
    text_release( own );
    return count > 0 ? WISP_OK
                     : scene_refuse( &r->source, field->key_line, field->key_column, "",
                                     "'%s' names nothing of the scene, such as surfaces[0].cloth.bending",
                                     scene_shorten( path ).text );
}

// ---- rows ----

enum
{
    ENTRY_FILE,
    ENTRY_NAME,
    ENTRY_STEPS,
    ENTRY_SECONDS,
    ENTRY_SET,
    ENTRY_VARY,
    ENTRY_ALONG,
    ENTRY_ORDER,
    ENTRY_BUDGETS,
    ENTRY_CHECKS,
    ENTRY_EXPECT,
    ENTRY_SWEEP,
    ENTRY_PAIRS,
    ENTRY_AGREE,
    ENTRY_COUNT,
};

static const char* const entry_keys[ENTRY_COUNT] = { "file",   "name",  "steps", "seconds", "set",
                                                     "vary",   "along", "order", "budgets", "checks",
                                                     "expect", "sweep", "pairs", "agree" };

// What an entry says.
typedef struct entry
{
    const text_node* values[ENTRY_COUNT];
    char* path;
    text_node* scene;
    suite_budget budgets[SUITE_BUDGET_COUNT];
    int along_count, rows;
    double seconds; // 0: none
    double order;   // NaN: none
    unsigned checks;
    stability_limits limits;
    bool is_refused;
} entry;

char* suite_resolve( const suite_reader* r, const char* file )
{
    const char* suite_path = r->source.name;
    const int folder = file[0] != '/' ? (int)io_folder_length( suite_path ) : 0;
    char* path = text_alloc( (size_t)folder + strlen( file ) );
    sprintf( path, "%.*s%s", folder, suite_path, file );
    return path;
}

void suite_stem( const char* path, char* out, size_t size )
{
    const char* name = io_file_name( path );
    const char* dot = strrchr( name, '.' );
    snprintf( out, size, "%.*s", dot && dot != name ? (int)( dot - name ) : (int)strlen( name ), name );
}

static suite_row* add_row( suite_reader* r )
{
    wisp_suite* s = r->out;
    if ( s->row_count == r->capacity )
    {
        r->capacity = r->capacity > 0 ? 2 * r->capacity : 16;
        suite_row* rows = text_alloc( (size_t)r->capacity * sizeof *rows );
        if ( s->rows != NULL )
        {
            memcpy( rows, s->rows, (size_t)s->row_count * sizeof *rows );
        }
        free( s->rows );
        s->rows = rows;
    }
    s->rows[s->row_count] = ( suite_row ){ .order = NAN, .known = -1 };
    return &s->rows[s->row_count++];
}

double suite_number_of( const text_node* node )
{
    char* end = NULL;
    const char* text = text_value( node );
    const double value = strtod( text, &end );
    return end == text || *end != '\0' ? NAN : value;
}

static void name_variant( const suite_reader* r, const text_node* field, const text_node* value, char* out,
                          size_t size )
{
    const char* path = field->key;
    const char* dot = strrchr( path, '.' );
    const size_t used = strlen( out );
    text_node* own = value_of( r, value );
    char* text = text_write( own, NULL );
    for ( char* line = strchr( text, '\n' ); line && own->kind == TEXT_LIST; line = strchr( line, '\n' ) )
    {
        *line = line[1] ? ' ' : '\0'; // a list is one line, "- 0 - 16"
    }
    text[strcspn( text, "\n" )] = '\0';
    snprintf( out + used, size - used, "%s%s=%s", used > 0 ? ", " : "", dot ? dot + 1 : path,
              text + strspn( text, " " ) );
    free( text );
    text_release( own );
}

// Keys of an entry that a scene does not have. @return whether the field is one of them
static bool set_key( const suite_reader* r, const text_node* field, suite_row* row, wisp_status* status )
{
    const char* key = field->key;
    if ( strcmp( key, entry_keys[ENTRY_SECONDS] ) == 0 )
    {
        row->seconds = suite_number_of( field );
        *status = row->seconds >= 1e-9 && row->seconds <= 1e9
                      ? WISP_OK
                      : suite_refuse( r, field, "expected seconds of simulated time" );
        return true;
    }
    if ( strcmp( key, entry_keys[ENTRY_EXPECT] ) == 0 )
    {
        *status = suite_read_expect( r, field, &row->is_refused );
        return true;
    }
    if ( strcmp( key, entry_keys[ENTRY_CHECKS] ) == 0 )
    {
        *status = suite_read_checks( r, field, &row->checks, &row->limits );
        return true;
    }
    return false;
}

static wisp_status set_fields( const suite_reader* r, text_node* scene, const text_node* fields, suite_row* row )
{
    wisp_status status = WISP_OK;
    for ( const text_node* n = fields ? text_first( fields ) : NULL; n && status == WISP_OK; n = n->next )
    {
        status = set_key( r, n, row, &status ) ? status : set_field( r, scene, n, n );
    }
    return status;
}

static const text_node* nth( const text_node* list, int n )
{
    const text_node* value = text_first( list );
    for ( ; n > 0; --n )
    {
        value = value->next;
    }
    return value;
}

// Give a field its value of number `which`: one of a list, or one of named bundles of fields, which change together.
static wisp_status choose_value( const suite_reader* r, const text_node* field, int which, text_node* scene,
                                 suite_row* row, double* number )
{
    const text_node* value = nth( field, which );
    const size_t used = strlen( row->variant );
    if ( field->kind == TEXT_LIST )
    {
        *number = suite_number_of( value );
        name_variant( r, field, value, row->variant, sizeof row->variant );
        return set_field( r, scene, field, value );
    }
    *number = strtod( value->key, NULL );
    snprintf( row->variant + used, sizeof row->variant - used, "%s%s=%s", used > 0 ? ", " : "", field->key,
              value->key );
    return set_fields( r, scene, value, row );
}

// Fields that vary, of the product's setting number `which`.
static wisp_status vary_fields( const suite_reader* r, const entry* e, int which, text_node* scene, suite_row* row )
{
    wisp_status status = WISP_OK;
    const text_node *vary = e->values[ENTRY_VARY], *along = e->values[ENTRY_ALONG];
    const text_node* last = along ? text_first( along ) : NULL;
    const int place = last ? which % last->count : 0;
    which /= last ? last->count : 1;
    for ( const text_node* n = vary ? text_first( vary ) : NULL; n && status == WISP_OK; n = n->next )
    {
        double number;
        status = choose_value( r, n, which % n->count, scene, row, &number );
        which /= n->count;
    }
    if ( status == WISP_OK && last )
    {
        snprintf( row->series, sizeof row->series, "%.60s%s%.120s", row->name, row->variant[0] ? ", " : "",
                  row->variant );
        snprintf( row->along, sizeof row->along, "%s", last->key );
        row->order = e->order;
        status = choose_value( r, last, place, scene, row, &row->along_value );
    }
    return status;
}

// Make the scene as long as the suite says. Steps that its events need stay.
static void set_length( text_node* scene, double seconds, suite_row* row )
{
    double dt = 1.0 / 60.0, steps = 1.0;
    text_is_number( text_find( scene, "dt" ), &dt );
    text_is_number( text_find( scene, "steps" ), &steps );
    const double needed = fmin( fmax( round( seconds / dt ), 1.0 ), 1e6 );
    if ( needed > steps )
    {
        text_set_number( text_put( scene, "steps", text_scalar( "1" ) ), needed );
    }
    row->steps = (int)needed;
}

wisp_status suite_row_of( const suite_row* like, const suite_given* given, suite_row* out, wisp_error* error )
{
    text_node* scene = NULL;
    *out = *like;
    out->given = given;
    out->text = NULL;
    out->variant[0] = '\0';
    const wisp_status status = text_parse( given->text, given->size, like->path, &scene, error );
    if ( status == WISP_OK )
    {
        set_length( scene, like->seconds, out );
        out->text = text_write( scene, NULL );
    }
    text_release( scene );
    return status;
}

static wisp_status finish_row( const suite_reader* r, const entry* e, text_node* scene, suite_row* row )
{
    if ( row->seconds > 0.0 )
    {
        set_length( scene, row->seconds, row );
    }
    row->text = text_write( scene, NULL );
    wisp_scene read = { 0 };
    wisp_error inner = { 0 };
    const int steps = row->steps;
    row->steps = 0; // the scene's own are compared
    wisp_status status = suite_scene( row, &read, row->is_refused ? &inner : r->source.error );
    row->steps = steps;
    if ( row->is_refused && status == WISP_BAD_INPUT )
    {
        snprintf( row->refusal, sizeof row->refusal, "%.199s", inner.message );
        return WISP_OK;
    }
    if ( status == WISP_OK && ( row->steps > read.steps || read.steps == 0 ) )
    {
        const text_node* place = e->values[ENTRY_STEPS] ? e->values[ENTRY_STEPS] : e->values[ENTRY_FILE];
        status = suite_refuse( r, place, "%s: got %d steps, the scene has %d", row->name, row->steps, read.steps );
    }
    wisp_scene_release( &read );
    return status;
}

static void begin_row( const suite_reader* r, const entry* e, suite_row* row )
{
    suite_stem( e->path, row->name, sizeof row->name );
    if ( e->values[ENTRY_NAME] )
    {
        snprintf( row->name, sizeof row->name, "%s", text_value( e->values[ENTRY_NAME] ) );
    }
    row->path = text_alloc( strlen( e->path ) );
    strcpy( row->path, e->path );
    row->given = r->given;
    memcpy( row->budgets, e->budgets, sizeof row->budgets );
    row->steps = e->values[ENTRY_STEPS] ? (int)suite_number_of( e->values[ENTRY_STEPS] ) : 0;
    row->seconds = e->seconds;
    row->checks = e->checks;
    row->limits = e->limits;
    row->is_refused = e->is_refused;
    row->agree = e->values[ENTRY_AGREE] ? suite_number_of( e->values[ENTRY_AGREE] ) : 0.0;
}

static wisp_status read_row( suite_reader* r, const entry* e, int which )
{
    suite_row* row = add_row( r );
    begin_row( r, e, row );
    text_node* own = text_copy( e->scene );
    wisp_status status = set_fields( r, own, e->values[ENTRY_SET], row );
    status = status == WISP_OK ? vary_fields( r, e, which, own, row ) : status;
    status = status == WISP_OK ? finish_row( r, e, own, row ) : status;
    text_release( own );
    return status;
}

// ---- sweeps ----

// A value of an axis: the name of a bundle and its fields. Null: none.
static wisp_status read_swept( suite_reader* r, const entry* e, const text_node* first, const text_node* second )
{
    suite_row* row = add_row( r );
    begin_row( r, e, row );
    snprintf( row->variant, sizeof row->variant, "%s%s%s", first ? first->key : "base", second ? ", " : "",
              second ? second->key : "" );
    text_node* own = text_copy( e->scene );
    wisp_status status = set_fields( r, own, e->values[ENTRY_SET], row );
    // where both set a field, the first one counts
    status = status == WISP_OK ? set_fields( r, own, second, row ) : status;
    status = status == WISP_OK ? set_fields( r, own, first, row ) : status;
    status = status == WISP_OK ? finish_row( r, e, own, row ) : status;
    text_release( own );
    return status;
}

static wisp_status find_axis( const suite_reader* r, const text_node* name, const text_node** out )
{
    const char* text = text_value( name );
    for ( const text_node* n = r->axes ? text_first( r->axes ) : NULL; n; n = n->next )
    {
        if ( strcmp( n->key, text ) == 0 )
        {
            *out = n;
            return WISP_OK;
        }
    }
    return suite_refuse( r, name, "axes has no '%s'", scene_shorten( text ).text );
}

static wisp_status sweep_pair( suite_reader* r, const entry* e, const text_node* axis, const text_node* other )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < axis->count && status == WISP_OK; ++i )
    {
        for ( int k = 0; k < other->count && status == WISP_OK; ++k )
        {
            status = r->out->row_count < SUITE_MAX_ROWS
                         ? read_swept( r, e, nth( axis, i ), nth( other, k ) )
                         : suite_refuse( r, axis, "a suite has at most %d rows", SUITE_MAX_ROWS );
        }
    }
    return status;
}

// The scene as it is, each value of each axis alone, and all pairs of values of different axes.
static wisp_status sweep( suite_reader* r, const entry* e )
{
    const text_node *axes = e->values[ENTRY_SWEEP], *pairs = e->values[ENTRY_PAIRS], *axis = NULL, *other = NULL;
    WISP_TRY( read_swept( r, e, NULL, NULL ) );
    for ( const text_node* n = text_first( axes ); n; n = n->next )
    {
        WISP_TRY( find_axis( r, n, &axis ) );
        for ( int i = 0; i < axis->count; ++i )
        {
            WISP_TRY( read_swept( r, e, nth( axis, i ), NULL ) );
        }
    }
    for ( const text_node* n = pairs ? text_first( pairs ) : NULL; n; n = n->next )
    {
        WISP_TRY( find_axis( r, n, &axis ) );
        for ( const text_node* m = n->next; m; m = m->next )
        {
            WISP_TRY( find_axis( r, m, &other ) );
            WISP_TRY( sweep_pair( r, e, axis, other ) );
        }
    }
    return WISP_OK;
}

static wisp_status check_sweep( const suite_reader* r, const entry* e )
{
    const text_node *axes = e->values[ENTRY_SWEEP], *pairs = e->values[ENTRY_PAIRS];
    if ( ( axes && axes->kind != TEXT_LIST ) || ( pairs && ( pairs->kind != TEXT_LIST || axes == NULL ) ) )
    {
        return suite_refuse( r, axes && axes->kind != TEXT_LIST ? axes : pairs,
                             "expected sweep, a list of names of axes, and with it at most pairs, another one" );
    }
    return axes && ( e->values[ENTRY_VARY] || e->values[ENTRY_ALONG] )
               ? suite_refuse( r, axes, "expected sweep, or vary and along, not both" )
               : WISP_OK;
}

wisp_status suite_check_axes( const suite_reader* r )
{
    bool is_good = r->axes->kind == TEXT_MAP;
    const text_node* place = r->axes;
    for ( const text_node* n = is_good ? text_first( r->axes ) : NULL; n && is_good; n = n->next )
    {
        is_good = n->kind == TEXT_MAP && n->count > 0;
        place = n;
        for ( const text_node* b = is_good ? text_first( n ) : NULL; b && is_good; b = b->next )
        {
            is_good = b->kind == TEXT_MAP;
            place = b;
        }
    }
    return is_good ? WISP_OK : suite_refuse( r, place, "expected axes, such as { size: { small: { dt: 0.01 } } }" );
}

// ---- entries ----

static wisp_status check_number( const suite_reader* r, const text_node* node, double least, double most,
                                 const char* expected )
{
    const double value = node ? suite_number_of( node ) : least;
    return value >= least && value <= most ? WISP_OK : suite_refuse( r, node, "expected %s", expected );
}

static wisp_status check_lists( const suite_reader* r, const text_node* fields, int* rows )
{
    for ( const text_node* n = fields ? text_first( fields ) : NULL; n; n = n->next )
    {
        bool has_bundles = n->kind == TEXT_MAP;
        for ( const text_node* b = has_bundles ? text_first( n ) : NULL; b; b = b->next )
        {
            has_bundles = has_bundles && b->kind == TEXT_MAP;
        }
        if ( ( n->kind != TEXT_LIST && !has_bundles ) || n->count == 0 )
        {
            return suite_refuse( r, n, "%s: expected a list of values, at least one, or names of bundles of fields",
                                 scene_shorten( n->key ).text );
        }
        *rows = *rows > SUITE_MAX_ROWS / n->count ? SUITE_MAX_ROWS + 1 : *rows * n->count;
    }
    return WISP_OK;
}

static wisp_status check_along( const suite_reader* r, const entry* e )
{
    const text_node* along = e->values[ENTRY_ALONG];
    if ( along && ( along->kind != TEXT_MAP || along->count != 1 ) )
    {
        return suite_refuse( r, along, "expected one field and its values, such as { substeps: [1, 2, 5, 10] }" );
    }
    const text_node* field = along ? text_first( along ) : NULL;
    for ( const text_node* n = field ? text_first( field ) : NULL; n; n = n->next )
    {
        const double value = field->kind == TEXT_MAP ? strtod( n->key, NULL ) : suite_number_of( n );
        if ( !( value > 0.0 ) || isinf( value ) )
        {
            return suite_refuse( r, n, "expected a number above 0, which a series goes along" );
        }
    }
    if ( field && strcmp( field->key, "dt" ) == 0 && e->seconds == 0.0 )
    {
        return suite_refuse(
            r, along, "a series along dt needs seconds, since runs of as many steps would end at other times" );
    }
    return WISP_OK;
}

static wisp_status check_settings( const suite_reader* r, entry* e )
{
    const text_node *const *v = e->values, *steps = v[ENTRY_STEPS];
    WISP_TRY( check_number( r, steps, 1.0, 1e6, "a number of steps, 1 to 1000000" ) );
    WISP_TRY( check_number( r, v[ENTRY_ORDER], 0.1, 8.0, "an order, 0.1 to 8" ) );
    WISP_TRY( check_number( r, v[ENTRY_SECONDS], 1e-9, 1e9, "seconds of simulated time" ) );
    WISP_TRY( v[ENTRY_AGREE]
                  ? check_number( r, v[ENTRY_AGREE], 1e-9, 1.0, "a part of the size of the first body, up to 1" )
                  : WISP_OK );
    if ( steps && suite_number_of( steps ) != floor( suite_number_of( steps ) ) )
    {
        return suite_refuse( r, steps, "expected a number of steps, 1 to 1000000" );
    }
    if ( steps && v[ENTRY_SECONDS] && v[ENTRY_SECONDS] != r->seconds )
    {
        return suite_refuse( r, steps, "expected steps or seconds, not both" );
    }
    if ( v[ENTRY_SET] && v[ENTRY_SET]->kind != TEXT_MAP )
    {
        return suite_refuse( r, v[ENTRY_SET], "expected fields and their values, such as { steps: 60 }" );
    }
    if ( v[ENTRY_VARY] && ( v[ENTRY_VARY]->kind != TEXT_MAP || v[ENTRY_VARY]->count > SUITE_MAX_SETTINGS ) )
    {
        return suite_refuse( r, v[ENTRY_VARY],
                             "expected up to %d fields and lists of values, such as { substeps: [4, 10] }",
                             (int)SUITE_MAX_SETTINGS );
    }
    e->seconds = v[ENTRY_SECONDS] && steps == NULL ? suite_number_of( v[ENTRY_SECONDS] ) : 0.0;
    e->order = v[ENTRY_ORDER] ? suite_number_of( v[ENTRY_ORDER] ) : NAN;
    e->rows = 1;
    WISP_TRY( check_along( r, e ) );
    WISP_TRY( check_lists( r, v[ENTRY_VARY], &e->rows ) );
    WISP_TRY( check_lists( r, v[ENTRY_ALONG], &e->rows ) );
    return e->rows + r->out->row_count <= SUITE_MAX_ROWS
               ? WISP_OK
               : suite_refuse( r,
                               v[ENTRY_VARY]    ? v[ENTRY_VARY]
                               : v[ENTRY_ALONG] ? v[ENTRY_ALONG]
                                                : v[ENTRY_FILE],
                               "the suite has more than %d rows", (int)SUITE_MAX_ROWS );
}

static wisp_status read_scene_text( const suite_reader* r, const text_node* file, const char* path, text_node** out )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_error inner = { 0 };
    const bool is_given = r->given != NULL;
    wisp_status status = is_given ? WISP_OK : io_file_read( path, SUITE_MAX_BYTES, &bytes, &size, &inner );
    const char* text = is_given ? r->given->text : (const char*)bytes;
    status = status == WISP_OK ? text_parse( text, is_given ? r->given->size : size, path, out, &inner ) : status;
    free( bytes );
    return status == WISP_OK ? WISP_OK : suite_refuse( r, file, "%s", inner.message );
}

static void release_entry( entry* e )
{
    text_release( e->scene );
    free( e->path );
}

wisp_status suite_read_entry( suite_reader* r, const text_node* block )
{
    entry e = { 0 };
    wisp_status status =
        suite_take_keys( r, block, "a scene, such as { file: scene.yaml }", entry_keys, ENTRY_COUNT, e.values );
    if ( status != WISP_OK )
    {
        return status;
    }
    const text_node *file = e.values[ENTRY_FILE], *name = e.values[ENTRY_NAME];
    if ( file == NULL || file->kind != TEXT_SCALAR || ( name && name->kind != TEXT_SCALAR ) )
    {
        return suite_refuse( r, block, "expected a file and at most one name of it, such as { file: scene.yaml }" );
    }
    e.values[ENTRY_SECONDS] = e.values[ENTRY_SECONDS] ? e.values[ENTRY_SECONDS] : r->seconds;
    memcpy( e.budgets, r->budgets, sizeof e.budgets );
    status = e.values[ENTRY_BUDGETS] ? suite_read_budgets( r, e.values[ENTRY_BUDGETS], e.budgets ) : WISP_OK;
    status = status == WISP_OK ? check_settings( r, &e ) : status;
    status = status == WISP_OK ? check_sweep( r, &e ) : status;
    e.checks = r->checks;
    e.limits = r->limits;
    status = status == WISP_OK && e.values[ENTRY_CHECKS]
                 ? suite_read_checks( r, e.values[ENTRY_CHECKS], &e.checks, &e.limits )
                 : status;
    status = status == WISP_OK && e.values[ENTRY_EXPECT]
                 ? suite_read_expect( r, e.values[ENTRY_EXPECT], &e.is_refused )
                 : status;
    if ( status == WISP_OK )
    {
        e.path = suite_resolve( r, text_value( file ) );
        status = read_scene_text( r, file, e.path, &e.scene );
    }
    status = status == WISP_OK && e.values[ENTRY_SWEEP] ? sweep( r, &e ) : status;
    for ( int i = 0; status == WISP_OK && e.values[ENTRY_SWEEP] == NULL && i < e.rows; ++i )
    {
        status = read_row( r, &e, i );
    }
    release_entry( &e );
    return status;
}

// ---- runs of a reference ----

wisp_status suite_read_run( const suite_reader* r, const suite_run* run, const char* name, suite_row* out )
{
    const suite_row* like = run->of ? run->of : r->out->rows;
    const text_node* place = run->file ? run->file : run->set;
    entry e = { .seconds = run->of      ? run->of->seconds
                           : r->seconds ? suite_number_of( r->seconds )
                                        : 0.0,
                .order = NAN };
    e.path = run->file ? suite_resolve( r, text_value( run->file ) )
                       : strcpy( text_alloc( strlen( like->path ) ), like->path );
    e.values[ENTRY_SET] = run->set;
    e.values[ENTRY_FILE] = place;
    wisp_status status =
        run->of ? text_parse( run->of->text, strlen( run->of->text ), run->of->path, &e.scene, r->source.error )
                : read_scene_text( r, place, e.path, &e.scene );
    if ( status == WISP_OK )
    {
        begin_row( r, &e, out );
        snprintf( out->name, sizeof out->name, "%s", name );
        for ( const text_node* n = text_first( run->set ); n; n = n->next )
        {
            name_variant( r, n, n, out->variant, sizeof out->variant );
        }
        status = set_fields( r, e.scene, run->set, out );
        status = status == WISP_OK ? set_fields( r, e.scene, run->coarser, out ) : status;
    }
    if ( status == WISP_OK && run->substeps > 0 )
    {
        text_set_number( text_put( e.scene, "substeps", text_scalar( "1" ) ), run->substeps );
    }
    status = status == WISP_OK ? finish_row( r, &e, e.scene, out ) : status;
    if ( e.seconds == 0.0 )
    {
        out->steps = like->steps;
    }
    release_entry( &e );
    return status;
}
