// Substeps of entities. An entity may ask for more substeps than the world makes: it splits each of those into as many
// as it needs. Its detail may allow it fewer: then it makes fewer and longer ones in the same time. Entities that meet in substeps
// have the substeps of the one with the most.
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
            if ( store_mask_has( &e->runs, node->passes[i] ) )
            {
                const store_mask touched = store_mask_or( plan_mask( pass->reads ), plan_mask( pass->writes ) );
                e->runs_waves = true;
                e->meets = e->meets || all_meet || pass->foreign[0] != 0 || store_mask_meets( touched, across );
            }
        }
    }
}

int plan_usual_substeps( const wisp_registry* r )
{
    return r->substeps > 1 ? r->substeps : 1;
}

// Rates are ordered by the number of substeps.
int plan_rate( const plan_entity* e, const wisp_registry* r )
{
    return e->fewer > 0 ? e->fewer - plan_usual_substeps( r ) : e->split;
}

int plan_substeps_of_rate( const wisp_registry* r, int rate, int of_world )
{
    const int64_t usual = plan_usual_substeps( r );
    return rate > 0 ? of_world * rate : (int)( ( (int64_t)of_world * ( usual + rate ) + usual - 1 ) / usual );
}

// Return the rate for what an entity asks for, and the limit that its detail sets.
static int rate_for( const store_entity* e, int usual )
{
    const int asked = e->substeps > usual ? ( e->substeps - 1 ) / usual + 1 : 1;
    const int limit = e->detail.max_substeps;
    if ( limit == 0 || limit >= asked * usual )
    {
        return asked;
    }
    return limit < usual ? limit - usual : ( limit - 1 ) / usual + 1;
}

static void set_rate( plan_entity* e, int rate, int usual )
{
    e->split = rate > 0 ? rate : 1;
    e->fewer = rate > 0 ? 0 : usual + rate;
}

void plan_find_splits( plan* p, const wisp_registry* r )
{
    const bool all_meet = has_followers( p, r );
    const int usual = plan_usual_substeps( r );
    int most = -usual; // of those that meet
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        plan_entity* e = p->entities + slot;
        find_meetings( p, r, slot, all_meet );
        const int rate = rate_for( r->store->entities + slot, usual );
        set_rate( e, rate, usual );
        most = e->meets && rate > most ? rate : most;
    }
    for ( int slot = 0; slot < r->store->entity_count; ++slot )
    {
        plan_entity* e = p->entities + slot;
        set_rate( e, e->meets ? most : plan_rate( e, r ), usual );
    }
}

int plan_next_rate( const plan* p, const wisp_registry* r, int rate )
{
    int next = 0;
    for ( int slot = 0; slot < p->entity_count; ++slot )
    {
        const plan_entity* e = p->entities + slot;
        const int own = plan_rate( e, r );
        const bool is_nearer = own > rate && ( next == 0 || own < next );
        next = e->runs_waves && e->loops == false && is_nearer ? own : next;
    }
    return next;
}
