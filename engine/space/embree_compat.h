/// Embree 3.13 or 4 under common names. Only this file includes Embree.
#pragma once

#if !defined( WISP_HAS_EMBREE )
#define WISP_HAS_EMBREE 0
#endif

#if WISP_HAS_EMBREE

#if defined( __has_include ) && __has_include( <embree4/rtcore.h> )
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <math.h>

#if RTC_VERSION_MAJOR >= 4

typedef struct RTCRayQueryContext embree_context;

static inline void embree_init_context( embree_context* context )
{
    rtcInitRayQueryContext( context );
}

static inline void embree_intersect( RTCScene scene, embree_context* context, struct RTCRayHit* ray )
{
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments( &arguments );
    arguments.context = context;
    rtcIntersect1( scene, ray, &arguments );
}

#else

typedef struct RTCIntersectContext embree_context;

static inline void embree_init_context( embree_context* context )
{
    rtcInitIntersectContext( context );
}

static inline void embree_intersect( RTCScene scene, embree_context* context, struct RTCRayHit* ray )
{
    rtcIntersect1( scene, context, ray );
}

#endif

/// Maximum coordinate of a ray. Embree with asserts aborts the process on a ray that is not finite or exceeds the
/// square root of the largest float.
#define EMBREE_LARGE 1.844e18f

static inline int embree_is_ray_fine( const struct RTCRay* r )
{
    return fabsf( r->org_x ) <= EMBREE_LARGE && fabsf( r->org_y ) <= EMBREE_LARGE &&
           fabsf( r->org_z ) <= EMBREE_LARGE && fabsf( r->dir_x ) <= EMBREE_LARGE &&
           fabsf( r->dir_y ) <= EMBREE_LARGE && fabsf( r->dir_z ) <= EMBREE_LARGE && r->tnear >= 0.0f &&
           r->tfar >= r->tnear && r->tfar <= EMBREE_LARGE;
}

#endif
