// The plan as text. The first column says where a pass runs, the second what it is called, then why it is there.
#include "plan.h"

#include <stdio.h>
#include <string.h>

typedef struct print_line
{
    char text[512];
    size_t length;
    void ( *write )( void* user, const char* line );
    void* user;
} print_line;

static void append( print_line* line, const char* text )
{
    int n = snprintf( line->text + line->length, sizeof( line->text ) - line->length, "%s", text );
    line->length += n > 0 ? (size_t)n : 0;
    line->length = line->length < sizeof( line->text ) ? line->length : sizeof( line->text ) - 1;
}

static void flush( print_line* line )
{
    line->write( line->user, line->text );
    line->length = 0;
    line->text[0] = 0;
}

static const char* name_of( const wisp_registry* r, wisp_component c )
{
    return r->store->components[c].def.name;
}

static bool is_wished( const wisp_registry* r, wisp_component c )
{
    bool wished = false;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        wished = wished || ( r->store->entities[slot].wants & store_bit( c ) ) != 0;
    }
    return wished;
}

static bool is_reader( const plan* p, const wisp_registry* r, int number, const wisp_pass* writer, wisp_component c )
{
    const wisp_pass* pass = r->passes + number;
    return ( p->live >> number & 1 ) != 0 && pass != writer && plan_lists( pass->reads, c );
}

// Who wants what the pass writes: a wish of an entity, or passes that read it. Of many readers the last ones are named:
// they are nearest to what the scene asked for.
static void append_reasons( print_line* line, const plan* p, const wisp_registry* r, const wisp_pass* pass )
{
    enum
    {
        NAMED = 3,
    };
    const char* separator = "wanted: ";
    for ( int i = 0; i < WISP_MAX_USES && pass->writes[i] != 0; ++i )
    {
        wisp_component c = pass->writes[i];
        int readers = 0;
        for ( int k = 0; k < r->pass_count; ++k )
        {
            readers += is_reader( p, r, k, pass, c ) ? 1 : 0;
        }
        if ( is_wished( r, c ) )
        {
            append( line, separator );
            append( line, name_of( r, c ) );
            append( line, " by the scene" );
            separator = ", ";
        }
        for ( int k = 0, seen = 0; k < r->pass_count; ++k )
        {
            bool reads = is_reader( p, r, k, pass, c );
            seen += reads ? 1 : 0;
            if ( reads && seen > readers - NAMED )
            {
                append( line, separator );
                append( line, name_of( r, c ) );
                append( line, " by " );
                append( line, r->passes[k].name );
                separator = ", ";
            }
        }
        if ( readers > NAMED )
        {
            char more[48];
            snprintf( more, sizeof( more ), " and by %d more", readers - NAMED );
            append( line, more );
        }
    }
}

static void print_pass( print_line* line, const plan* p, const wisp_registry* r, const plan_node* node, int i )
{
    static const char* const SECTIONS[PLAN_SECTION_COUNT] = { "before",      "substep",   "iteration",
                                                              "substep end", "item loop", "after" };
    const wisp_pass* pass = r->passes + node->passes[i];
    char head[160];
    snprintf( head, sizeof( head ), "  %-11s wave %d  %-24s ", SECTIONS[node->section], node->wave, pass->name );
    append( line, head );
    append( line, i > 0 ? "(fused) " : "" );
    append_reasons( line, p, r, pass );
    flush( line );
}

static bool anybody_has( const wisp_registry* r, wisp_component c )
{
    return r->store->components[c].entity_count > 0;
}

// Does every entity that has all it needs have something that it must not have?
static bool is_kept_out( const wisp_registry* r, const wisp_pass* pass )
{
    const store_mask needs = plan_mask( pass->needs ), lacks = plan_mask( pass->lacks );
    bool kept_out = false;
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        const store_entity* e = r->store->entities + slot;
        const bool suits = e->alive && ( needs & ~e->components ) == 0;
        if ( suits && ( lacks & e->components ) == 0 )
        {
            return false;
        }
        kept_out = kept_out || suits;
    }
    return kept_out;
}

static void print_absent( print_line* line, const wisp_registry* r, const wisp_pass* pass )
{
    char head[160];
    snprintf( head, sizeof( head ), "  absent              %-24s ", pass->name );
    append( line, head );
    for ( int i = 0; i < WISP_MAX_USES && pass->needs[i] != 0; ++i )
    {
        if ( anybody_has( r, pass->needs[i] ) == false )
        {
            append( line, "needs " );
            append( line, name_of( r, pass->needs[i] ) );
            append( line, ", which no entity has" );
            flush( line );
            return;
        }
    }
    if ( is_kept_out( r, pass ) )
    {
        append( line, "only without" );
        for ( int i = 0; i < WISP_MAX_USES && pass->lacks[i] != 0; ++i )
        {
            append( line, i == 0 ? " " : " and " );
            append( line, name_of( r, pass->lacks[i] ) );
        }
        flush( line );
        return;
    }
    append( line, "nobody wants " );
    append( line, name_of( r, pass->writes[0] ) );
    flush( line );
}

static int widest( const plan* p )
{
    int waves = 0;
    for ( int i = 0; i < PLAN_SECTION_COUNT; ++i )
    {
        waves += p->wave_count[i];
    }
    return waves;
}

void plan_print( const plan* p, const wisp_registry* r, void ( *write )( void* user, const char* line ), void* user )
{
    print_line line = { .write = write, .user = user };
    bool substeps = p->wave_count[PLAN_SUBSTEP] + p->wave_count[PLAN_ITERATION] +
                        p->wave_count[PLAN_AFTER_ITERATION] + p->wave_count[PLAN_ITEM_LOOP] >
                    0;
    char head[160];
    snprintf( head, sizeof( head ), "plan %016llx: %d passes in %d nodes and %d waves, %s",
              (unsigned long long)p->hash, p->pass_count, p->node_count, widest( p ),
              substeps ? "with a substep loop" : "no substep loop" );
    append( &line, head );
    flush( &line );
    for ( int section = 0; section < PLAN_SECTION_COUNT; ++section )
    {
        for ( int wave = 0; wave < p->wave_count[section]; ++wave )
        {
            for ( int n = 0; n < p->node_count; ++n )
            {
                const plan_node* node = p->nodes + n;
                for ( int i = 0; i < node->pass_count && (int)node->section == section && node->wave == wave; ++i )
                {
                    print_pass( &line, p, r, node, i );
                }
            }
        }
    }
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( ( p->live >> i & 1 ) == 0 )
        {
            print_absent( &line, r, r->passes + i );
        }
    }
}
