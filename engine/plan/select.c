// Selection: the passes of each entity, what supplies their reads, and the rows and arrays that they need.
#include "compile_parts.h"

// Select a pass if the entity has all required components and its output is requested, by the entity or by the
// reads of a selected pass. Repeat until nothing changes.
static store_mask live_passes( const wisp_registry* r, const store_entity* e )
{
    store_mask live = { { 0 } }, requested = e->alive ? e->requests : live;
    const store_mask components = store_mask_and_not( e->components, e->derived );
    for ( bool grew = true; grew; )
    {
        grew = false;
        for ( int i = 0; i < r->pass_count; ++i )
        {
            const wisp_pass* pass = r->passes + i;
            bool lives = store_mask_has( &live, i );
            bool fits = store_mask_holds( components, plan_mask( pass->required ) ) &&
                        store_mask_meets( components, plan_mask( pass->excluded ) ) == false;
            if ( lives == false && fits && store_mask_meets( plan_mask( pass->writes ), requested ) )
            {
                store_mask_add( &live, i );
                requested = store_mask_or( requested, plan_mask( pass->reads ) );
                grew = true;
            }
        }
    }
    return live;
}

// Check that every request and every read has a supplier: rows of the entity, or a selected pass that writes them.
static wisp_status check_supply( const wisp_registry* r, store_mask live, int slot, wisp_error* error )
{
    const store_entity* e = r->store->entities + slot;
    store_mask supplied = store_mask_and_not( e->components, e->derived );
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( store_mask_has( &live, i ) )
        {
            supplied = store_mask_or( supplied, plan_mask( r->passes[i].writes ) );
        }
    }
    for ( int c = 1; c < r->store->component_count; ++c )
    {
        if ( store_mask_has( &e->requests, c ) && store_mask_has( &supplied, c ) == false )
        {
            return wisp_fail( error, WISP_CONFLICT, "'%s': requested of entity %d, but no pass can write it there",
                              r->store->components[c].def.name, slot + 1 );
        }
    }
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const store_mask missing = store_mask_and_not( plan_mask( r->passes[i].reads ), supplied );
        for ( int c = 1; c < r->store->component_count && store_mask_has( &live, i ); ++c )
        {
            if ( store_mask_has( &missing, c ) )
            {
                return wisp_fail( error, WISP_CONFLICT,
                                  "pass '%s': reads '%s', which entity %d does not have and no active pass writes",
                                  r->passes[i].name, r->store->components[c].def.name, slot + 1 );
            }
        }
    }
    return WISP_OK;
}

// ---- rows and arrays ----

bool plan_attach_rows( plan* p, store* s, int slot, store_mask components )
{
    for ( int c = 1; c < s->component_count; ++c )
    {
        store_entity* e = s->entities + slot;
        if ( store_mask_has( &components, c ) && store_mask_has( &e->components, c ) == false )
        {
            if ( store_attach( s, store_handle( s, slot ), (wisp_component)c ) == false )
            {
                return false;
            }
            store_mask_add( &e->derived, c );
            store_mask_add( &p->entities[slot].came, c );
        }
    }
    return true;
}

void plan_detach_rows( store* s, int slot, store_mask components )
{
    for ( int c = 1; c < s->component_count; ++c )
    {
        if ( store_mask_has( &components, c ) && store_mask_has( &s->entities[slot].derived, c ) )
        {
            store_detach( s, store_handle( s, slot ), (wisp_component)c );
        }
    }
}

store_mask plan_used_by( const wisp_registry* r, store_mask passes )
{
    store_mask used = { { 0 } };
    for ( int i = 0; i < r->pass_count; ++i )
    {
        if ( store_mask_has( &passes, i ) )
        {
            used = store_mask_or( used, plan_mask( r->passes[i].reads ) );
            used = store_mask_or( used, plan_mask( r->passes[i].writes ) );
        }
    }
    return used;
}

// Make what selected passes read of the fabric.
static wisp_status need_fabric( const wisp_registry* r, const store_entity* e, store_mask live )
{
    unsigned arrays = 0;
    for ( int i = 0; i < r->pass_count; ++i )
    {
        arrays |= store_mask_has( &live, i ) ? r->passes[i].fabric : 0u;
    }
    return arrays != 0 && e->fabric != NULL ? wisp_fabric_need( e->fabric, arrays ) : WISP_OK;
}

// Return those of some passes that run at a detail. The others keep their place in the plan, and their rows.
static store_mask passes_at( const wisp_registry* r, store_mask live, wisp_detail detail )
{
    for ( int i = 0; i < r->pass_count; ++i )
    {
        const unsigned use = r->passes[i].detail;
        const bool runs = detail == WISP_DETAIL_NOTHING  ? ( use & WISP_PASS_WITHOUT_MOTION ) != 0
                          : detail == WISP_DETAIL_COARSE ? ( use & WISP_PASS_FINE ) == 0
                                                         : true;
        if ( runs == false )
        {
            store_mask_remove( &live, i );
        }
    }
    return live;
}

wisp_status plan_select( plan* p, const wisp_registry* r, wisp_error* error )
{
    store* s = r->store;
    for ( int slot = 0; slot < s->entity_count; ++slot )
    {
        const store_mask live = live_passes( r, s->entities + slot );
        p->entities[slot] =
            ( plan_entity ){ .live = live, .runs = passes_at( r, live, s->entities[slot].detail.level ) };
        WISP_TRY( s->entities[slot].alive ? check_supply( r, live, slot, error ) : WISP_OK );
        // rows that mean nothing between steps follow when fusions are known
        const store_mask used = store_mask_and_not( plan_used_by( r, live ), s->transient );
        if ( s->entities[slot].alive && plan_attach_rows( p, s, slot, used ) == false )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the rows between the passes of entity %d",
                              slot + 1 );
        }
        wisp_status status = s->entities[slot].alive ? need_fabric( r, s->entities + slot, live ) : WISP_OK;
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "out of memory for the topology that passes of entity %d read",
                              slot + 1 );
        }
        p->live = store_mask_or( p->live, live );
    }
    return WISP_OK;
}
