#include "slip.h"

void contact_add_way( const contact_contact_mesh* s, const contact_row* row, int begin, int end, float way[3] )
{
    for ( int i = begin; i < end; ++i )
    {
        const float *p = s->now + (size_t)row->point[i] * 4, *q = s->intersection_free + (size_t)row->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            way[k] += row->weight[i] * ( p[k] - q[k] );
        }
    }
}

void contact_find_slip( contact_row* row, const float way[3], float most, float by[3] )
{
    const float* n = row->normal;
    const float along = n[0] * way[0] + n[1] * way[1] + n[2] * way[2];
    float requested[3], squared = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        requested[k] = row->tangential_correction[k] - ( way[k] - along * n[k] );
        squared += requested[k] * requested[k];
    }
    const float scale = squared > most * most ? most / sqrtf( squared ) : 1.0f;
    for ( int k = 0; k < 3; ++k )
    {
        by[k] = scale * requested[k] - row->tangential_correction[k];
        row->tangential_correction[k] = scale * requested[k];
    }
}
