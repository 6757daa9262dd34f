// The first line of a part.
#include "sweep_header.h"

#include "results_json.h"
#include "wisp/wisp.h"

#include <math.h>
#include <string.h>

enum
{
    VERSION = 1, // of the format
};

void sweep_describe_machine( const char* isa, sweep_header* out )
{
    const machine_info machine = machine_describe( isa );
    snprintf( out->version, sizeof out->version, "%s", machine.version );
    snprintf( out->commit, sizeof out->commit, "%s", machine.commit );
    snprintf( out->compiler, sizeof out->compiler, "%s", machine.compiler );
    snprintf( out->flags, sizeof out->flags, "%s", machine.flags );
    snprintf( out->build_type, sizeof out->build_type, "%s", machine.build_type );
    snprintf( out->cpu, sizeof out->cpu, "%s", machine.cpu );
    snprintf( out->isa, sizeof out->isa, "%s", machine.isa );
    snprintf( out->os, sizeof out->os, "%s", machine.os );
    snprintf( out->host, sizeof out->host, "%s", machine.host );
    out->cores = machine.cores;
    out->memory_bytes = machine.memory_bytes;
}

// Texts of a header: where they are, and their room.
typedef struct text_field
{
    const char* name;
    char* text;
    size_t size;
} text_field;

enum
{
    TEXTS = 12,
};

static void list_texts( sweep_header* h, text_field out[TEXTS] )
{
    const text_field all[TEXTS] = {
        { "suite", h->suite, sizeof h->suite },
        { "title", h->title, sizeof h->title },
        { "reference", h->reference, sizeof h->reference },
        { "version", h->version, sizeof h->version },
        { "commit", h->commit, sizeof h->commit },
        { "compiler", h->compiler, sizeof h->compiler },
        { "flags", h->flags, sizeof h->flags },
        { "build_type", h->build_type, sizeof h->build_type },
        { "cpu", h->cpu, sizeof h->cpu },
        { "isa", h->isa, sizeof h->isa },
        { "os", h->os, sizeof h->os },
        { "host", h->host, sizeof h->host },
    };
    memcpy( out, all, sizeof all );
}

char* sweep_header_write( const sweep_header* header )
{
    sweep_header h = *header;
    text_field texts[TEXTS];
    list_texts( &h, texts );
    json_t* object = json_object();
    json_object_set_new( object, "wisp_sweep", json_integer( VERSION ) );
    for ( int i = 0; i < TEXTS; ++i )
    {
        json_object_set_new( object, texts[i].name, results_json_text( texts[i].text ) );
    }
    json_object_set_new( object, "key", sweep_hash( h.key ) );
    json_object_set_new( object, "items", json_integer( h.items ) );
    json_object_set_new( object, "shard", json_integer( h.shard + 1 ) );
    json_object_set_new( object, "shards", json_integer( h.shards ) );
    json_object_set_new( object, "exclusive", json_boolean( h.is_exclusive ) );
    json_object_set_new( object, "workers", json_integer( h.workers ) );
    json_object_set_new( object, "doubt", sweep_number( h.doubt ) );
    json_object_set_new( object, "parts_at", sweep_number( h.parts_at ) );
    json_object_set_new( object, "cores", json_integer( h.cores ) );
    json_object_set_new( object, "memory_bytes", sweep_number( h.memory_bytes ) );
    char* line = json_dumps( object, JSON_COMPACT | JSON_REAL_PRECISION( 17 ) );
    json_decref( object );
    return line;
}

bool sweep_header_read( const char* line, size_t size, sweep_header* out )
{
    *out = ( sweep_header ){ 0 };
    json_t* object = json_loadb( line, size, JSON_REJECT_DUPLICATES, NULL );
    text_field texts[TEXTS];
    list_texts( out, texts );
    bool good = sweep_whole_of( json_object_get( object, "wisp_sweep" ), VERSION, VERSION ) == VERSION;
    for ( int i = 0; i < TEXTS && good; ++i )
    {
        good = sweep_text_of( json_object_get( object, texts[i].name ), texts[i].text, texts[i].size );
    }
    out->items = sweep_whole_of( json_object_get( object, "items" ), 1, SUITE_MAX_ROWS );
    out->shards = sweep_whole_of( json_object_get( object, "shards" ), 1, SWEEP_MAX_SHARDS );
    out->shard = sweep_whole_of( json_object_get( object, "shard" ), 1, out->shards ) - 1;
    out->workers = sweep_whole_of( json_object_get( object, "workers" ), 0, 1 << 20 );
    out->workers = sweep_whole_of( json_object_get( object, "workers" ), 0, 1 << 20 );
    out->cores = sweep_whole_of( json_object_get( object, "cores" ), 0, 1 << 20 );
    out->is_exclusive = json_is_true( json_object_get( object, "exclusive" ) );
    out->doubt = sweep_number_of( json_object_get( object, "doubt" ) );
    out->parts_at = sweep_number_of( json_object_get( object, "parts_at" ) );
    out->memory_bytes = sweep_number_of( json_object_get( object, "memory_bytes" ) );
    good = good && out->items > 0 && out->shards > 0 && out->shard >= 0 && out->cores >= 0 && out->workers >= 0 &&
           sweep_hash_of( json_object_get( object, "key" ), &out->key );
    json_decref( object );
    return good;
}

static bool is_same_number( double a, double b )
{
    return a == b || ( isnan( a ) && isnan( b ) );
}

const char* sweep_difference( const sweep_header* a, const sweep_header* b )
{
    const bool is_suite = a->key == b->key && a->items == b->items;
    const bool is_version = strcmp( a->version, b->version ) == 0 && strcmp( a->commit, b->commit ) == 0;
    const bool is_reference = strcmp( a->reference, b->reference ) == 0 && is_same_number( a->doubt, b->doubt ) &&
                              is_same_number( a->parts_at, b->parts_at );
    return !is_suite                                                        ? "another suite"
           : !is_version                                                    ? "another version of Wisp"
           : a->shards != b->shards                                         ? "another number of shards"
           : !is_reference                                                  ? "another reference"
           : a->is_exclusive && b->is_exclusive && a->workers != b->workers ? "another number of workers"
                                                                            : NULL;
}
