// Entries that have a name, and values that name them.
#include "nearest.h"
#include "scene_parts.h"

#include <stdlib.h>
#include <string.h>

static const struct
{
    const char *one, *there_is;
} WORDS[] = {
    [SCENE_STRANDS] = { "strands", "there are no strands" },
    [SCENE_SURFACE] = { "surface", "there is no surface" },
    [SCENE_COLLIDER] = { "collider", "there is no collider" },
    [SCENE_SEAM] = { "seam", "there is no seam" },
};

// Entries of one name stay in the order of the lists, and within a list in that of the file.
static int compare_names( const void* a, const void* b )
{
    const scene_name *x = a, *y = b;
    int order = strcmp( x->text, y->text );
    order = order ? order : (int)x->what - (int)y->what;
    return order ? order : ( x->index > y->index ) - ( x->index < y->index );
}

// Sorted first: comparing each with each would take minutes for a hostile list.
static wisp_status refuse_equal_names( scene_reader* r )
{
    for ( int i = 1; i < r->name_count; ++i )
    {
        const scene_name *name = &r->names[i], *before = name - 1;
        if ( strcmp( name->text, before->text ) == 0 )
        {
            scene_enter_index( r, name->index );
            return scene_refuse( r->source, name->line, name->column, r->path,
                                 "the name '%s' is taken by the %s in line %d", name->text, WORDS[before->what].one,
                                 before->line );
        }
    }
    return WISP_OK;
}

wisp_status scene_register( scene_reader* r, scene_named what, const void* entries, size_t size, int count )
{
    if ( count == 0 )
    {
        return WISP_OK;
    }
    scene_name* names = scene_take( r->scene, (size_t)r->name_count + (size_t)count, sizeof *names );
    if ( !names )
    {
        return scene_no_memory( r );
    }
    if ( r->name_count > 0 )
    {
        memcpy( names, r->names, (size_t)r->name_count * sizeof *names );
    }
    for ( int i = 0; i < count; ++i )
    {
        const scene_entry* entry = (const void*)( (const char*)entries + (size_t)i * size );
        names[r->name_count + i] = ( scene_name ){ entry->name, i, entry->line, entry->column, what };
    }
    r->names = names;
    r->name_count += count;
    qsort( names, (size_t)r->name_count, sizeof *names, compare_names );
    return refuse_equal_names( r );
}

// ---- values that name an entry ----

static wisp_status refuse_name( scene_reader* r, const scene_node* node, const char* text, const scene_name* other,
                                scene_named what )
{
    const scene_quote quote = scene_shorten( text );
    if ( other )
    {
        return scene_refuse_node( r, node, "%s '%s': that is the %s in line %d", WORDS[what].there_is, quote.text,
                                  WORDS[other->what].one, other->line );
    }
    const char** known = scene_take( r->scene, (size_t)r->name_count + 1, sizeof *known );
    if ( !known )
    {
        return scene_no_memory( r );
    }
    int count = 0;
    for ( int i = 0; i < r->name_count; ++i )
    {
        if ( r->names[i].what == what )
        {
            known[count++] = r->names[i].text;
        }
    }
    const char* near = nearest_word( text, known, count );
    return scene_refuse_node( r, node, "%s '%s'%s%s%s%s", WORDS[what].there_is, quote.text,
                              count == 0 ? ": the scene has none" : "", near ? ", did you mean '" : "",
                              near ? near : "", near ? "'?" : "" );
}

static int compare_text( const void* key, const void* element )
{
    return strcmp( key, ( (const scene_name*)element )->text );
}

const scene_name* scene_find_name( const scene_reader* r, const char* text )
{
    return r->name_count ? bsearch( text, r->names, (size_t)r->name_count, sizeof( scene_name ), compare_text )
                         : NULL;
}

wisp_status scene_read_named( scene_reader* r, const scene_node* node, scene_named what, int* index )
{
    const char* text = NULL;
    wisp_status status = scene_read_text( r, node, &text );
    if ( status )
    {
        return status;
    }
    const scene_name* found = scene_find_name( r, text );
    if ( !found || found->what != what )
    {
        return refuse_name( r, node, text, found, what );
    }
    *index = found->index;
    return WISP_OK;
}

// ---- lists of entries ----

wisp_status scene_begin_list( scene_reader* r, const scene_node* node, const char* what, int most, size_t size,
                              void** items )
{
    *items = NULL;
    wisp_status status = scene_expect_list( r, node, what );
    if ( status || node->count == 0 )
    {
        return status;
    }
    if ( node->count > most )
    {
        return scene_refuse_node( r, node, "got %d entries, expected at most %d", node->count, most );
    }
    *items = scene_take( r->scene, (size_t)node->count, size );
    return *items ? WISP_OK : scene_no_memory( r );
}
