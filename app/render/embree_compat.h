/// Embree 3.13 and 4 under one set of names. Included by one file.
#pragma once

#if defined( RENDER_EMBREE4 )
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if RTC_VERSION_MAJOR >= 4

static inline void embree_intersect( RTCScene scene, struct RTCRayHit* ray )
{
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments( &arguments );
    rtcIntersect1( scene, ray, &arguments );
}

static inline void embree_occluded( RTCScene scene, struct RTCRay* ray )
{
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments( &arguments );
    rtcOccluded1( scene, ray, &arguments );
}

#else

static inline void embree_intersect( RTCScene scene, struct RTCRayHit* ray )
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext( &context );
    rtcIntersect1( scene, &context, ray );
}

static inline void embree_occluded( RTCScene scene, struct RTCRay* ray )
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext( &context );
    rtcOccluded1( scene, &context, ray );
}

#endif

// Embree 3 shows a geometry under every mask by default, Embree 4 under the first bit only.
static inline void embree_show_always( RTCGeometry geometry )
{
    rtcSetGeometryMask( geometry, 0xFFFFFFFFu );
}
