// Any bytes as a base file of the gate: refused with one message that begins with the name, or a base with rows whose values can be
// compared.
#include "fuzz.h"

#include "gate_check.h"

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    gate_base base;
    wisp_error error = { .status = WISP_OK };
    const wisp_status status = gate_base_parse( (const char*)data, size, "base.json", &base, &error );
    if ( status != WISP_OK )
    {
        demand_refusal( status, &error );
        demand( strncmp( error.message, "base.json:", 10 ) == 0 );
    }
    else
    {
        demand( base.row_count > 0 && base.row_count <= SUITE_MAX_ROWS );
    }
    for ( int i = 0; i < base.row_count && status == WISP_OK; ++i )
    {
        const gate_base_row* row = base.rows + i;
        suite_row now = { .steps = row->measured.steps };
        gate_row_check check;
        memcpy( now.name, row->name, sizeof now.name );
        memcpy( now.variant, row->variant, sizeof now.variant );
        demand( row->measured.pass_count <= SUITE_MAX_PASSES );
        gate_check_row( &now, &base, true, &row->measured, &check );
        demand( check.base != NULL && check.state != GATE_NEW );
    }
    gate_base_release( &base );
    return 0;
}
