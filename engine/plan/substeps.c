// Substeps of entities. An entity may ask for more substeps than the world makes: it splits each of those into as many
// as it needs. Entities that meet in substeps have the substeps of the one with the most.
#include "plan.h"

// Return what passes of other entities touch of an entity in the substep loop.
static store_mask columns_across( const plan* p, const wisp_registry* r, int slot )
{
    const store_mask components = r->store->entities[slot].components;
    store_mask across = { { 0 } };
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->pass_count && plan_is_substep( node->section ); ++i )
        {
            const wisp_pass* pass = r->passes + node->passes[i];
            const bool reaches = pass->among == 0 || store_mask_has( &components, pass->among );
            across = reaches ? store_mask_or( across, plan_mask( pass->foreign ) ) : across;
        }
    }
    return across;
}

// Does a pass follow entities that it does not list? Which ones only the module knows, so all meet.
static bool has_followers( const plan* p, const wisp_registry* r )
{
    bool found = false;
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->pass_count && plan_is_substep( node->section ); ++i )
        {
            found = found || r->passes[node->passes[i]].follows;
        }
    }
    return found;
}

// Find whether an entity runs substeps in waves, and whether others touch what it has there, or it touches theirs.
static void find_meetings( plan* p, const wisp_registry* r, int slot, bool all_meet )
{
    plan_entity* e = p->entities + slot;
    const store_mask across = columns_across( p, r, slot );
    e->runs_waves = e->meets = false;
    for ( int n = 0; n < p->node_count; ++n )
    {
        const plan_node* node = p->nodes + n;
        for ( int i = 0; i < node->pass_count && plan_is_substep( node->section ); ++i )
        {
            const wisp_pass* pass = r->passes + node->passes[i];
            if ( store_mask_has( &e->live, node->passes[i] ) )
            {
                const store_mask touched = store_mask_or( plan_mask( pass->reads ), plan_mask( pass->writes ) );
                e->runs_waves = true;
                e->meets = e->meets || all_meet || pass->foreign[0] != 0 || store_mask_meets( touched, across );
            }
        }
    }
}

static int split_for( int substeps, int of_world )
{
    return substeps > of_world ? ( substeps - 1 ) / of_world + 1 : 1;
}

void plan_find_splits( plan* p, const wisp_registry* r )
{
    const bool all_meet = has_followers( p, r );
    int most = 1; // of those that meet
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        plan_entity* e = p->entities + slot;
        find_meetings( p, r, slot, all_meet );
        e->split = split_for( r->store->entities[slot].substeps, r->substeps > 1 ? r->substeps : 1 );
        most = e->meets && e->split > most ? e->split : most;
    }
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        p->entities[slot].split = p->entities[slot].meets ? most : p->entities[slot].split;
    }
}

int plan_next_split( const plan* p, int split )
{
    int next = 0;
    for ( int slot = 0; slot < p->entity_count; ++slot )
    {
        const plan_entity* e = p->entities + slot;
        const bool is_nearer = e->split > split && ( next == 0 || e->split < next );
        next = e->runs_waves && e->loops == false && is_nearer ? e->split : next;
    }
    return next;
}
