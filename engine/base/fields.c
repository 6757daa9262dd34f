// Definitions by table: defaults, reading and ranges of all members. In: rows of wisp_fields. Out: a definition, or a message that names
// the member, the value and the range.
#include "log.h"
#include "wisp/module/definition.h"
#include "wisp/shapes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t size_of( wisp_field_type type )
{
    switch ( type )
    {
        case WISP_FIELD_DOUBLE:
            return sizeof( double );
        case WISP_FIELD_SWITCH:
            return sizeof( bool );
        case WISP_FIELD_SEED:
            return sizeof( uint64_t );
        case WISP_FIELD_VECTOR:
        case WISP_FIELD_POINT:
            return sizeof( wisp_vec3 );
        case WISP_FIELD_POSE:
            return sizeof( wisp_transform );
        default:
            return sizeof( int32_t ); // also a float
    }
}

// ---- defaults ----

static void write_initial( const wisp_field* f, void* at )
{
    const double x = f->initial[0];
    const wisp_vec3 v = { (float)x, (float)f->initial[1], (float)f->initial[2] };
    const int64_t whole = f->type != WISP_FIELD_NUMBER && f->type != WISP_FIELD_DOUBLE ? (int64_t)x : 0;
    const int32_t low = (int32_t)whole; // -1: all bits
    const bool is_on = whole != 0;
    const wisp_transform pose = { .rotation = { 0.0f, 0.0f, 0.0f, 1.0f } };
    const void* const values[] = {
        [WISP_FIELD_NUMBER] = &v,   [WISP_FIELD_DOUBLE] = &x,     [WISP_FIELD_WHOLE] = &low,
        [WISP_FIELD_CHOICE] = &low, [WISP_FIELD_SWITCH] = &is_on, [WISP_FIELD_BITS] = &low,
        [WISP_FIELD_SEED] = &whole, [WISP_FIELD_VECTOR] = &v,     [WISP_FIELD_POINT] = &v,
        [WISP_FIELD_POSE] = &pose,
    };
    memcpy( at, values[f->type], size_of( f->type ) );
}

void wisp_def_init( const wisp_fields* fields, void* def, size_t size )
{
    if ( def == NULL || size < sizeof( uint32_t ) )
    {
        return;
    }
    // a host that was compiled with a newer version finds zeros in what this one does not know
    const uint32_t stored = (uint32_t)size;
    memset( def, 0, size );
    memcpy( def, &stored, sizeof( stored ) );
    for ( int i = 0; i < fields->count; ++i )
    {
        const wisp_field* f = fields->rows + i;
        if ( f->offset + size_of( f->type ) <= size )
        {
            write_initial( f, (char*)def + f->offset );
        }
    }
}

// ---- ranges ----

static wisp_status refuse( const wisp_fields* fields, const wisp_field* f, const char* part, double value,
                           wisp_error* error )
{
    const bool has_other = f->other < f->lower || f->other > f->upper;
    const int digits = f->type == WISP_FIELD_WHOLE ? 10 : 6;
    char other[40] = "";
    if ( has_other )
    {
        snprintf( other, sizeof( other ), "%g or ", f->other );
    }
    return wisp_fail( error, WISP_BAD_INPUT, "%s: %s%s: got %.*g, expected %s%.*g to %.*g%s%s", fields->subject,
                      f->name, part, digits, value, other, digits, f->lower, digits, f->upper,
                      f->unit != NULL ? " " : "", f->unit != NULL ? f->unit : "" );
}

// Check a float as the limits are when they are rounded to one. NaN lies nowhere.
static bool is_float_in( const wisp_field* f, float value )
{
    return ( value >= (float)f->lower && value <= (float)f->upper ) || value == (float)f->other;
}

static wisp_status check_coordinates( const wisp_fields* fields, const wisp_field* f, wisp_vec3 v, wisp_error* error )
{
    const float xyz[3] = { v.x, v.y, v.z };
    static const char* const parts[3] = { ".x", ".y", ".z" };
    for ( int k = 0; k < 3; ++k )
    {
        if ( is_float_in( f, xyz[k] ) == false )
        {
            return refuse( fields, f, parts[k], (double)xyz[k], error );
        }
    }
    return WISP_OK;
}

static wisp_status check_length( const wisp_fields* fields, const wisp_field* f, wisp_vec3 v, wisp_error* error )
{
    const float length = sqrtf( v.x * v.x + v.y * v.y + v.z * v.z );
    return length >= (float)f->lower && length <= (float)f->upper
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT,
                            "%s: %s: got (%g, %g, %g), expected a vector of length %g to %g%s%s", fields->subject,
                            f->name, (double)v.x, (double)v.y, (double)v.z, f->lower, f->upper,
                            f->unit != NULL ? " " : "", f->unit != NULL ? f->unit : "" );
}

static wisp_status check_pose( const wisp_fields* fields, const wisp_field* f, const wisp_transform* pose,
                               wisp_error* error )
{
    const wisp_vec3 p = pose->translation;
    const wisp_quat q = pose->rotation;
    const float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if ( !( is_float_in( f, p.x ) && is_float_in( f, p.y ) && is_float_in( f, p.z ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: %s: got position (%g, %g, %g), expected finite coordinates within %g m of the origin",
                          fields->subject, f->name, (double)p.x, (double)p.y, (double)p.z, f->upper );
    }
    return squared >= 1e-12f && squared <= 1e12f
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: %s: the quaternion (%g, %g, %g, %g) is not a rotation",
                            fields->subject, f->name, (double)q.x, (double)q.y, (double)q.z, (double)q.w );
}

// @param part such as " of vertex 5", which the message has behind the name
static wisp_status check_field( const wisp_fields* fields, const wisp_field* f, const char* part, const void* at,
                                wisp_error* error )
{
    float number;
    double exact = 0.0;
    int32_t whole;
    unsigned char byte;
    wisp_vec3 v;
    wisp_transform pose;
    switch ( f->type )
    {
        case WISP_FIELD_NUMBER:
            memcpy( &number, at, sizeof( number ) );
            return is_float_in( f, number ) ? WISP_OK : refuse( fields, f, part, (double)number, error );
        case WISP_FIELD_DOUBLE:
            memcpy( &exact, at, sizeof( exact ) );
            break;
        case WISP_FIELD_WHOLE:
        case WISP_FIELD_CHOICE:
            memcpy( &whole, at, sizeof( whole ) );
            exact = (double)whole;
            break;
        case WISP_FIELD_SWITCH:
            memcpy( &byte, at, sizeof( byte ) );
            exact = (double)byte;
            break;
        case WISP_FIELD_VECTOR:
            memcpy( &v, at, sizeof( v ) );
            return check_length( fields, f, v, error );
        case WISP_FIELD_POINT:
            memcpy( &v, at, sizeof( v ) );
            return check_coordinates( fields, f, v, error );
        case WISP_FIELD_POSE:
            memcpy( &pose, at, sizeof( pose ) );
            return check_pose( fields, f, &pose, error );
        case WISP_FIELD_BITS:
        case WISP_FIELD_SEED:
            return WISP_OK;
    }
    return ( exact >= f->lower && exact <= f->upper ) || exact == f->other ? WISP_OK
                                                                           : refuse( fields, f, part, exact, error );
}

// ---- reading ----

wisp_status base_check_value( const wisp_fields* fields, const char* name, const char* of, int number,
                              const void* value, wisp_error* error )
{
    int i = 0;
    while ( i < fields->count && strcmp( fields->rows[i].name, name ) != 0 )
    {
        i += 1;
    }
    WISP_ASSERT( i < fields->count );
    char part[60] = "";
    if ( of != NULL )
    {
        snprintf( part, sizeof( part ), " of %s %d", of, number );
    }
    return check_field( fields, fields->rows + i, part, value, error );
}

wisp_status wisp_def_read( const wisp_fields* fields, void* def, const void* given, wisp_error* error )
{
    const uint32_t own = (uint32_t)fields->size;
    uint32_t size;
    wisp_def_init( fields, def, fields->size );
    if ( given == NULL )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "definition: got null, expected one from wisp_default_%s()",
                          fields->definition );
    }
    memcpy( &size, given, sizeof( size ) );
    if ( size <= sizeof( size ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "definition: got size %u, expected one that wisp_default_%s() has filled", (unsigned)size,
                          fields->definition );
    }
    if ( size > own )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "definition: got size %u, expected at most %u: wisp_default_%s() has not filled it, or the "
                          "program was compiled with a newer version than %s",
                          (unsigned)size, (unsigned)own, fields->definition, wisp_version() );
    }
    memcpy( def, given, size );
    memcpy( def, &own, sizeof( own ) );
    for ( int i = 0; i < fields->count; ++i )
    {
        WISP_TRY( check_field( fields, fields->rows + i, "", (const char*)def + fields->rows[i].offset, error ) );
    }
    return WISP_OK;
}
