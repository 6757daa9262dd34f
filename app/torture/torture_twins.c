#include "torture_twins.h"

#include "interruption.h"
#include "scene_parts.h"
#include "wisp/module/random.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

// ---- blocks ----

// The table of a mapping, and the struct with its defaults.
typedef struct torture_block
{
    const scene_block* table; // null: no table describes it
    const void* base;
} torture_block;

// Defaults of everything, made at the first use.
typedef struct defaults
{
    bool is_made;
    wisp_scene scene;
    wisp_scene_strands strands;
    wisp_scene_surface surface;
    wisp_scene_collider collider;
    wisp_scene_seam seam;
    wisp_groom_generator grooms[3];
    wisp_mesh_generator meshes[WISP_MESH_SHAPE_COUNT];
    wisp_scene_hair_event hair_event;
    scene_event event;
    wisp_scene_output output;
    wisp_scene_pose pose;
    wisp_scene_box box;
} defaults;

static const defaults* find_defaults( void )
{
    static defaults d;
    if ( !d.is_made )
    {
        d.scene = scene_defaults();
        d.strands = scene_default_strands( d.scene.gravity );
        d.surface = scene_default_surface( d.scene.gravity );
        d.collider = scene_default_collider();
        d.seam = scene_default_seam();
        for ( int i = 0; i < WISP_COUNT( d.grooms ); ++i )
        {
            d.grooms[i] = wisp_default_groom_generator( (wisp_groom_shape)i, 3 );
        }
        for ( int i = 0; i < WISP_MESH_SHAPE_COUNT; ++i )
        {
            d.meshes[i] = wisp_default_mesh_generator( (wisp_mesh_shape)i );
        }
        d.is_made = true;
    }
    return &d;
}

static torture_block block_of_scene( void )
{
    return ( torture_block ){ &SCENE_BLOCK_OF_ALL, &find_defaults()->scene };
}

static const scene_field* find_field( const scene_block* table, const char* key )
{
    for ( int i = 0; i < table->field_count; ++i )
    {
        if ( strcmp( table->fields[i].key, key ) == 0 )
        {
            return &table->fields[i];
        }
    }
    return NULL;
}

// The number of the word that `shape` has, 0 if it has none.
static int shape_of( const scene_block* table, const text_node* map )
{
    const scene_field* field = find_field( table, "shape" );
    const char* word = text_at( map, "shape" );
    for ( int i = 0; field && field->choices[i].word; ++i )
    {
        if ( strcmp( field->choices[i].word, word ) == 0 )
        {
            return i;
        }
    }
    return 0;
}

static bool is_collider( const scene_block* table )
{
    return table >= SCENE_COLLIDER_BLOCKS && table < SCENE_COLLIDER_BLOCKS + WISP_COLLIDER_COUNT;
}

static torture_block block_of_scene_key( const char* key, const text_node* value )
{
    const defaults* d = find_defaults();
    const struct
    {
        const char* key;
        torture_block block;
    } rows[] = {
        { "contact", { &SCENE_WORLD_CONTACT_BLOCK, &d->scene } },
        { "strands", { &SCENE_STRANDS_BLOCK, &d->strands } },
        { "surfaces", { &SCENE_SURFACE_BLOCK, &d->surface } },
        { "colliders", { &SCENE_COLLIDER_BLOCKS[shape_of( SCENE_COLLIDER_BLOCKS, value )], &d->collider } },
        { "seams", { &SCENE_SEAM_BLOCK, &d->seam } },
        { "hair_events", { &SCENE_COMMAND_BLOCK, &d->hair_event } },
        { "events", { &SCENE_EVENT_BLOCK, &d->event } },
        { "output", { &SCENE_OUTPUT_BLOCK, &d->output } },
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        if ( strcmp( rows[i].key, key ) == 0 )
        {
            return rows[i].block;
        }
    }
    return ( torture_block ){ NULL, NULL };
}

static torture_block block_below( torture_block block, const char* key, const text_node* value )
{
    const defaults* d = find_defaults();
    if ( block.table == &SCENE_BLOCK_OF_ALL )
    {
        return block_of_scene_key( key, value );
    }
    const scene_field* field = block.table ? find_field( block.table, key ) : NULL;
    if ( field == NULL || field->block != NULL )
    {
        return ( torture_block ){ field ? field->block : NULL, block.base };
    }
    const bool is_mesh = block.table == &SCENE_SURFACE_BLOCK || is_collider( block.table );
    if ( strcmp( key, "generate" ) == 0 )
    {
        const int mesh = is_mesh ? shape_of( SCENE_MESH_BLOCKS, value ) : 0;
        return is_mesh
                   ? ( torture_block ){ &SCENE_MESH_BLOCKS[mesh], &d->meshes[mesh] }
                   : ( torture_block ){ &SCENE_GENERATE_BLOCK, &d->grooms[shape_of( &SCENE_GENERATE_BLOCK, value )] };
    }
    if ( strcmp( key, "keyframes" ) == 0 )
    {
        return ( torture_block ){ &SCENE_POSITION_BLOCK, &d->pose };
    }
    if ( strcmp( key, "pin_keyframes" ) == 0 )
    {
        return ( torture_block ){ &SCENE_PIN_POSE_BLOCK, &d->pose };
    }
    return strcmp( key, "pin_box" ) == 0 ? ( torture_block ){ &SCENE_BOX_BLOCK, &d->box }
                                         : ( torture_block ){ NULL, NULL };
}

// ---- at another size, and elsewhere ----

// A scene at another size, and elsewhere. Both go by the tables of the reader: a key's unit says how it scales.

// ---- size ----

// The power of a length in each unit, with masses and times as they are.
static int length_power( const char* unit, const char* key )
{
    static const struct
    {
        const char* unit;
        int power;
    } powers[] = {
        { "m", 1 },       { "m/s", 1 },   { "m/s^2", 1 },   { "m^2", 2 },   { "m^3/s", 3 },
        { "kg/m^2", -2 }, { "kg/m", -1 }, { "kg/m^3", -3 }, { "Pa", -1 },   { "N m", 2 },
        { "N m^2", 3 },   { "m/N", 0 },   { "N/m", 0 },     { "N s/m", 0 }, { "N", 1 },
    };
    // R T / M is the square of a speed, and the gas constant is fixed.
    if ( strcmp( key, "temperature" ) == 0 )
    {
        return 2;
    }
    for ( int i = 0; unit && i < WISP_COUNT( powers ); ++i )
    {
        if ( strcmp( powers[i].unit, unit ) == 0 )
        {
            return powers[i].power;
        }
    }
    return 0;
}

// A number that leaves the range of its key stays at its end: lists of places have no range.
static void multiply( text_node* node, double factor, scene_range range )
{
    double value;
    if ( text_is_number( node, &value ) )
    {
        const bool has_range = range.upper > range.lower;
        value *= factor;
        text_set_number( node, has_range ? fmin( fmax( value, range.lower ), range.upper ) : value );
    }
    for ( int i = 0; i < node->count; ++i )
    {
        multiply( node->children[i], factor, range );
    }
}

// What a key has where it is not written, as a node; null where that is found from other keys, or nothing at any
// size.
static text_node* default_of( const scene_field* field, const void* base )
{
    const void* at = (const char*)base + field->at;
    if ( field->initial != NULL || ( field->type != SCENE_NUMBER && field->type != SCENE_VECTOR ) )
    {
        return NULL;
    }
    const wisp_vec3* v = at;
    const bool is_zero =
        field->type == SCENE_NUMBER ? *(const float*)at == 0.0f : v->x == 0.0f && v->y == 0.0f && v->z == 0.0f;
    if ( is_zero )
    {
        return NULL;
    }
    if ( field->type == SCENE_NUMBER )
    {
        return text_scalar( "%.9g", (double)*(const float*)at );
    }
    text_node* list = text_list();
    text_add( list, text_scalar( "%.9g", (double)v->x ) );
    text_add( list, text_scalar( "%.9g", (double)v->y ) );
    text_add( list, text_scalar( "%.9g", (double)v->z ) );
    return list;
}

// Keys whose values are places in a list that no table describes.
static bool is_list_of_places( const char* key )
{
    return strcmp( key, "pin_nearest" ) == 0;
}

static void scale_block( text_node* map, torture_block block, double factor );

static void scale_value( text_node* value, torture_block block, const scene_field* field, double factor )
{
    const int power = ( is_list_of_places( field->key ) ? 1 : length_power( field->unit, field->key ) );
    if ( power != 0 )
    {
        multiply( value, pow( factor, power ), field->range );
        return;
    }
    for ( int i = -1; i < value->count; ++i )
    {
        text_node* inner = i < 0 ? value : value->children[i];
        const torture_block below =
            inner->kind == TEXT_MAP ? block_below( block, field->key, inner ) : ( torture_block ){ NULL, NULL };
        if ( below.table != NULL )
        {
            scale_block( inner, below, factor );
        }
        if ( value->kind != TEXT_LIST )
        {
            break;
        }
    }
}

// A mesh from a file has its scale, which has no unit.
static void scale_file( text_node* map, double factor )
{
    if ( text_find( map, "file" ) == NULL )
    {
        return;
    }
    text_node* owner = text_find( map, "shape" ) ? map : text_find( map, "transform" );
    owner = owner ? owner : text_put( map, "transform", text_map() );
    double scale = 1.0;
    text_is_number( text_find( owner, "scale" ), &scale );
    text_put( owner, "scale", text_scalar( "%.9g", scale * factor ) );
}

static void scale_block( text_node* map, torture_block block, double factor )
{
    const bool is_event = block.table == &SCENE_EVENT_BLOCK;
    for ( int i = 0; i < block.table->field_count; ++i )
    {
        const scene_field own = scene_field_at( block.table, i ), *field = &own;
        text_node* value = text_find( map, field->key );
        // Gravity of a body is that of the scene unless it is written, and an event changes only what is written.
        const bool has_default =
            !is_event && ( is_list_of_places( field->key ) ? 1 : length_power( field->unit, field->key ) ) != 0;
        if ( value == NULL && has_default )
        {
            value = default_of( field, block.base );
            value = value ? text_put( map, field->key, value ) : NULL;
        }
        if ( value != NULL )
        {
            scale_value( value, block, field, factor );
        }
    }
    scale_file( map, factor );
}

void torture_scale( text_node* scene, double factor )
{
    scale_block( scene, block_of_scene(), factor );
}

// ---- place ----

static void add_offset( text_node* vector, const double offset[3] )
{
    for ( int i = 0; i < 3 && i < vector->count; ++i )
    {
        double value = 0.0;
        text_is_number( vector->children[i], &value );
        text_set_number( vector->children[i], value + offset[i] );
    }
}

static text_node* vector_of( text_node* map, const char* key )
{
    text_node* vector = text_find( map, key );
    if ( vector == NULL )
    {
        vector = text_put( map, key, text_list() );
        for ( int i = 0; i < 3; ++i )
        {
            text_add( vector, text_scalar( "0" ) );
        }
    }
    return vector;
}

// Keys that are a place of the world wherever they stand; displacements such as those of pins are none.
static void shift_below( text_node* node, const double offset[3] )
{
    static const char* const places[] = { "position", "cursor",         "pivot", "pin_pivot",
                                          "eye",      "outlet_nearest", "min",   "max" };
    for ( int i = 0; i < node->count; ++i )
    {
        text_node* child = node->children[i];
        bool is_place = false;
        for ( int k = 0; child->key && k < WISP_COUNT( places ); ++k )
        {
            is_place |= strcmp( child->key, places[k] ) == 0;
        }
        if ( is_place && child->kind == TEXT_LIST )
        {
            add_offset( child, offset );
        }
        for ( int k = 0; child->key && is_list_of_places( child->key ) && k < child->count; ++k )
        {
            add_offset( child->children[k], offset );
        }
        shift_below( child, offset );
    }
}

void torture_shift( text_node* scene, const double offset[3] )
{
    static const char* const lists[] = { "surfaces", "strands", "colliders" };
    for ( int k = 0; k < WISP_COUNT( lists ); ++k )
    {
        text_node* list = text_find( scene, lists[k] );
        for ( int i = 0; list && i < list->count; ++i )
        {
            text_node* entry = list->children[i];
            const bool follows = text_find( entry, "scatter" ) || text_find( entry, "curves" );
            if ( k < 2 && !follows )
            {
                text_node* transform = text_find( entry, "transform" );
                transform = transform ? transform : text_put( entry, "transform", text_map() );
                add_offset( vector_of( transform, "translate" ), offset );
            }
            else if ( k == 2 )
            {
                (void)vector_of( entry, "position" );
            }
        }
    }
    shift_below( scene, offset );
}

// ---- twins ----

// A scene run again in another way: with other workers, after a snapshot, at another size, elsewhere.

// Longer runs find little more, and each twin costs as much as the run itself.
static const int TWIN_STEPS = 60;

static int twin_steps( const wisp_scene* scene )
{
    return scene->steps < TWIN_STEPS ? scene->steps : TWIN_STEPS;
}

wisp_status torture_read( const torture_subject* subject, wisp_scene* out, wisp_error* error )
{
    char* text = text_write( subject->tree, NULL );
    const wisp_status status = wisp_scene_parse( text, strlen( text ), subject->name, out, error );
    free( text );
    return status;
}

// ---- snapshots ----

// What a host keeps besides the world: where the scene's script is.
typedef struct script_place
{
    int next_step, next_command, next_event;
    void* pins;
} script_place;

static script_place save_place( const scene_world* world )
{
    const script_place out = { world->next_step, world->next_command, world->next_event,
                               text_alloc( scene_pins_state_size( world ) + 1 ) };
    scene_pins_save( world, out.pins );
    return out;
}

static void load_place( const script_place* place, scene_world* out )
{
    out->next_step = place->next_step;
    out->next_command = place->next_command;
    out->next_event = place->next_event;
    scene_pins_load( out, place->pins );
}

typedef struct snapshot_run
{
    scene_world worlds[2]; // the one that the snapshot comes from, and a new one
    script_place place;    // where the script was
    void* bytes;
    size_t size;
    uint64_t *expected, *found; // hashes of the steps that follow
    int half, left;
} snapshot_run;

static bool judge_restored( snapshot_run* run, int world, int expected, stability_verdict* out )
{
    scene_world* restored = &run->worlds[world];
    load_place( &run->place, restored );
    if ( wisp_world_restore( restored->world, run->bytes, run->size ) != WISP_OK )
    {
        *out = ( stability_verdict ){ .check = STABILITY_SNAPSHOT, .step = run->half, .severity = 1.0 };
        snprintf( out->message, sizeof out->message, "a snapshot after step %d is refused: %.200s", run->half,
                  wisp_world_message( restored->world ) );
        return false;
    }
    char how[80];
    snprintf( how, sizeof how, "in %s world that a snapshot after step %d was restored into",
              world == 0 ? "the same" : "a new", run->half );
    const int count = stability_hash_steps( restored, run->left, run->found );
    return stability_compare_bits( run->expected, expected, run->found, count, STABILITY_SNAPSHOT, run->half, how,
                                   out );
}

// Both worlds have made a step, which compiles the plan.
static bool judge_snapshot_of( snapshot_run* run, stability_verdict* out )
{
    run->expected = text_alloc( (size_t)run->left * sizeof *run->expected );
    run->found = text_alloc( (size_t)run->left * sizeof *run->found );
    run->place = save_place( &run->worlds[0] );
    run->size = wisp_world_snapshot_size( run->worlds[0].world );
    run->bytes = text_alloc( run->size );
    bool holds = wisp_world_snapshot( run->worlds[0].world, run->bytes, run->size ) == WISP_OK;
    const int expected = stability_hash_steps( &run->worlds[0], run->left, run->expected );
    for ( int world = 0; world < 2 && holds; ++world )
    {
        holds = judge_restored( run, world, expected, out );
    }
    free( run->bytes );
    free( run->place.pins );
    free( run->expected );
    free( run->found );
    return holds;
}

static bool judge_snapshot( const wisp_scene* scene, stability_verdict* out )
{
    const scene_world_options options = { .workers = 1, .isa = NULL, .is_quiet = true };
    const int steps = twin_steps( scene );
    const uint64_t random = wisp_random_mix( ( (uint64_t)scene->steps << 32 ) + (uint64_t)scene->substeps );
    snapshot_run run = { .half = steps > 1 ? 1 + (int)( random % (uint64_t)( steps - 1 ) ) : 0 };
    run.left = steps - run.half;
    if ( steps < 2 || scene_world_create( scene, &options, &run.worlds[0], NULL ) != WISP_OK )
    {
        return true;
    }
    bool holds = true;
    if ( scene_world_create( scene, &options, &run.worlds[1], NULL ) == WISP_OK )
    {
        bool has_stepped = scene_world_step( &run.worlds[1], NULL ) == WISP_OK;
        for ( int i = 0; i < run.half; ++i )
        {
            has_stepped = has_stepped && scene_world_step( &run.worlds[0], NULL ) == WISP_OK;
        }
        holds = !has_stepped || judge_snapshot_of( &run, out );
        scene_world_destroy( &run.worlds[1] );
    }
    scene_world_destroy( &run.worlds[0] );
    return holds;
}

// ---- another size, another place ----

bool torture_compare_traces( const stability_trace* trace, const stability_trace* twin, stability_check judge,
                             stability_verdict* out )
{
    // Crumpled cloth falls into other folds after any rounding: only a stretch that is of another order is another
    // motion.
    const double APART = 0.5, FACTOR = 3.0;
    const char* where = judge == STABILITY_SCALE ? "at another size" : "100 m away";
    stability_verdict other;
    if ( !stability_judge_trace( twin, STABILITY_ALL, NULL, &other ) )
    {
        *out = ( stability_verdict ){ .check = judge, .step = other.step, .severity = other.severity };
        snprintf( out->message, sizeof out->message, "%s: %.250s", where, other.message );
        return false;
    }
    for ( int body = 0; body < trace->body_count && stability_is_at_rest( trace ); ++body )
    {
        const stability_body *a = &trace->bodies[body], *b = &twin->bodies[body];
        const double larger = fmax( a->stretch, b->stretch ), smaller = fmin( a->stretch, b->stretch );
        if ( a->moves && a->softness < 1.0 && !stability_is_held( trace, body ) && larger > APART + FACTOR * smaller )
        {
            *out = ( stability_verdict ){ .check = judge,
                                          .step = trace->steps,
                                          .severity = larger / ( APART + FACTOR * smaller ) };
            snprintf( out->message, sizeof out->message,
                      "%s has an edge stretched by %.3g %% at the end, and by %.3g %% %s", a->name,
                      100.0 * a->stretch, 100.0 * b->stretch, where );
            return false;
        }
    }
    return true;
}

// Takes the tree, which is released.
static bool judge_alike( const torture_subject* subject, text_node* tree, const stability_trace* trace,
                         stability_check judge, stability_verdict* out )
{
    const torture_subject moved = { tree, subject->name };
    wisp_scene scene;
    wisp_error error = { 0 };
    stability_trace twin = { 0 };
    bool holds = true;
    // What is beyond a range at another size says nothing.
    if ( torture_read( &moved, &scene, &error ) == WISP_OK )
    {
        holds = stability_trace_run( &scene, NULL, &twin, &error ) != WISP_OK ||
                torture_compare_traces( trace, &twin, judge, out );
        stability_trace_release( &twin );
    }
    wisp_scene_release( &scene );
    text_release( tree );
    return holds;
}

// Run the twins of a scene whose trace holds. @return whether all hold
static bool judge_twins( const torture_subject* subject, const stability_trace* trace, int twins,
                         stability_verdict* out )
{
    wisp_scene scene;
    wisp_error error = { 0 };
    if ( torture_read( subject, &scene, &error ) != WISP_OK )
    {
        return true;
    }
    bool holds = ( twins & TORTURE_TWIN_BITS ) == 0 || stability_judge_bits( &scene, twin_steps( &scene ), out );
    holds = holds && ( ( twins & TORTURE_TWIN_SNAPSHOT ) == 0 || judge_snapshot( &scene, out ) );
    wisp_scene_release( &scene );
    if ( holds && ( twins & TORTURE_TWIN_SCALE ) )
    {
        text_node* tree = text_copy( subject->tree );
        torture_scale( tree, trace->steps % 2 == 0 ? 10.0 : 0.1 );
        holds = judge_alike( subject, tree, trace, STABILITY_SCALE, out );
    }
    if ( holds && ( twins & TORTURE_TWIN_SHIFT ) )
    {
        text_node* tree = text_copy( subject->tree );
        torture_shift( tree, ( const double[] ){ 60.0, 0.0, 80.0 } );
        holds = judge_alike( subject, tree, trace, STABILITY_SHIFT, out );
    }
    return holds;
}

// ---- a process ----

// A scene in a process of its own: a crash or an endless loop is a verdict like any other.

static void refuse( stability_verdict* out, const wisp_error* error )
{
    *out = ( stability_verdict ){ .check = STABILITY_REFUSED, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "%.310s", error->message );
}

// What happens in the child.
static stability_verdict judge_here( const torture_subject* subject, int twins )
{
    const unsigned checks = STABILITY_ALL | ( twins & TORTURE_CLOSE ? STABILITY_CLOSE : 0u );
    stability_verdict verdict = { .check = STABILITY_HOLDS };
    wisp_error error = { 0 };
    wisp_scene scene;
    if ( torture_read( subject, &scene, &error ) != WISP_OK )
    {
        refuse( &verdict, &error );
        return verdict;
    }
    stability_trace trace;
    if ( stability_trace_run( &scene, NULL, &trace, &error ) != WISP_OK )
    {
        refuse( &verdict, &error );
    }
    else if ( stability_judge_trace( &trace, checks, NULL, &verdict ) && ( twins & TORTURE_TWIN_ALL ) != 0 )
    {
        judge_twins( subject, &trace, twins, &verdict );
    }
    stability_trace_release( &trace );
    wisp_scene_release( &scene );
    return verdict;
}

// A core file of each crash would fill the disk.
static _Noreturn void be_child( const torture_subject* subject, int twins, int out )
{
    const struct rlimit none = { 0, 0 };
    setrlimit( RLIMIT_CORE, &none );
    interruption_leave_to_parent();
    static const int fatal[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT };
    for ( int i = 0; i < WISP_COUNT( fatal ); ++i )
    {
        signal( fatal[i], SIG_DFL ); // a host that catches them would go on as two processes
    }
    const stability_verdict verdict = judge_here( subject, twins );
    const ssize_t written = write( out, &verdict, sizeof verdict );
    _exit( written == (ssize_t)sizeof verdict ? 0 : 1 );
}

torture_child torture_start( const torture_subject* subject, int twins, double seconds )
{
    torture_child child = { .pid = -1, .in = -1, .seconds = seconds, .end = wisp_clock_seconds() + seconds };
    int ends[2];
    fflush( NULL );
    if ( pipe( ends ) != 0 )
    {
        return child;
    }
    child.in = ends[0];
    child.pid = fork();
    if ( child.pid == 0 )
    {
        close( ends[0] );
        be_child( subject, twins, ends[1] );
    }
    close( ends[1] );
    return child;
}

// Wait until the verdict is there, the child is gone, or its time is over. A verdict that is there counts, however late
// it is asked for.
static bool wait_for( const torture_child* child, stability_verdict* out )
{
    const double SLICE = 0.2; // s: a signal just before poll() does not end it
    struct pollfd wait = { child->in, POLLIN, 0 };
    double left = 0.0;
    do
    {
        left = interruption_came() ? 0.0 : fmax( 0.0, child->end - wisp_clock_seconds() );
        const int ready = poll( &wait, 1, (int)( 1e3 * fmin( left, SLICE ) ) );
        if ( ready > 0 )
        {
            return read( child->in, out, sizeof *out ) == (ssize_t)sizeof *out;
        }
        if ( ready < 0 && errno != EINTR )
        {
            break;
        }
    } while ( left > 0.0 );
    *out = ( stability_verdict ){ .check = STABILITY_TIME, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "the scene did not end within %.3g s", child->seconds );
    return true;
}

stability_verdict torture_finish( const torture_child* child )
{
    stability_verdict verdict = { .check = STABILITY_CRASH, .severity = 1.0 };
    if ( child->pid < 0 )
    {
        snprintf( verdict.message, sizeof verdict.message, "no process could be started" );
        return verdict;
    }
    const bool has_verdict = wait_for( child, &verdict );
    close( child->in );
    if ( has_verdict && verdict.check == STABILITY_TIME )
    {
        kill( child->pid, SIGKILL );
    }
    int status = 0;
    waitpid( child->pid, &status, 0 );
    if ( !has_verdict )
    {
        verdict = ( stability_verdict ){ .check = STABILITY_CRASH, .severity = 1.0 };
        snprintf( verdict.message, sizeof verdict.message, "the process ended without a verdict: %s",
                  WIFSIGNALED( status ) ? strsignal( WTERMSIG( status ) ) : "an exit" );
    }
    return verdict;
}

stability_verdict torture_judge_scene( const torture_subject* subject, int twins, double seconds )
{
    const torture_child child = torture_start( subject, twins, seconds );
    return torture_finish( &child );
}
