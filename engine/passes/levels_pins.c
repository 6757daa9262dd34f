// Pins between the rows of a coarse sheet. A pinned vertex of the surface that is no row of the sheet is a point of it: the mean
// of the rows that it follows, by their weights. A sheet that is held nowhere would fall and take the surface along, so the point
// moves with the pin, after every pass over the links.
//
// On a sheet that is not the finest, the point is that of the row of the next finer sheet which the pin follows most.
#include "levels.h"

static int heaviest_parent( const wisp_fabric_level* level, int finer_row )
{
    int best = -1;
    float weight = 0.0f;
    for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
    {
        const size_t at = levels_parent_at( finer_row, k );
        if ( level->weight[at] > weight )
        {
            best = level->parent_x4[at] / 4;
            weight = level->weight[at];
        }
    }
    return best;
}

// @return the row of the next finer sheet that stands for a pin; the slot itself on the finest one; -1 if there is none, or if the
// row is pinned and stands for itself
static int find_finer_row( const levels_surface* s, int number, int slot )
{
    int row = slot;
    for ( int l = 0; l < number && row >= 0; ++l )
    {
        const wisp_fabric_level* level = s->fabric->levels + l;
        row = heaviest_parent( level, row );
        const bool own = row >= 0 && level->slot_x4[row] == 4 * slot;
        row = own || row < 0 || s->position[level->slot_x4[row] + 3] > 0.0f ? row : -1;
    }
    return row;
}

static bool make_pin( const levels_surface* s, int number, int slot, levels_pin* pin )
{
    const wisp_fabric_level* level = s->fabric->levels + number;
    const float* inverse_mass = s->inverse_mass + level->first_row;
    const int finer_row = find_finer_row( s, number, slot );
    float sum = 0.0f;
    *pin = ( levels_pin ){ 0 };
    for ( int k = 0; k < WISP_FABRIC_PARENTS && finer_row >= 0; ++k )
    {
        const size_t at = levels_parent_at( finer_row, k );
        const float weight = level->weight[at];
        const int32_t row_x4 = level->parent_x4[at];
        const float* previous = s->previous + level->slot_x4[row_x4 / 4];
        pin->row_x4[k] = row_x4;
        pin->weight[k] = weight;
        sum += weight * weight * inverse_mass[row_x4 / 4];
        for ( int axis = 0; axis < 3; ++axis )
        {
            pin->from[axis] += weight * previous[axis];
        }
    }
    for ( int axis = 0; axis < 3; ++axis )
    {
        pin->moved[axis] = s->position[4 * slot + axis] - s->previous[4 * slot + axis];
    }
    pin->scale = sum > 0.0f ? 1.0f / sum : 0.0f;
    return sum > 0.0f;
}

int levels_find_pins( const levels_surface* s, int number, levels_pin* pins, int room )
{
    int count = 0;
    for ( int slot = 0; slot < s->fabric->vertex_count; ++slot )
    {
        levels_pin pin;
        if ( s->position[4 * slot + 3] <= 0.0f && make_pin( s, number, slot, &pin ) )
        {
            if ( count < room )
            {
                pins[count] = pin;
            }
            count += 1;
        }
    }
    return count;
}

void levels_project_pins( const levels_sheet* sheet )
{
    float* position = sheet->links.position;
    for ( const levels_pin* p = sheet->pins; p < sheet->pins + sheet->pin_count; ++p )
    {
        for ( int axis = 0; axis < 3; ++axis )
        {
            float error = -( p->from[axis] + sheet->pin_fraction * p->moved[axis] );
            for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
            {
                error += p->weight[k] * position[p->row_x4[k] + axis];
            }
            for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
            {
                float* row = position + p->row_x4[k];
                row[axis] -= p->scale * p->weight[k] * row[3] * error;
            }
        }
    }
}
