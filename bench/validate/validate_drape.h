/// Cusick's test: named fabrics drape over a disc.
#pragma once

#include "accuracy/accuracy.h"

#define DRAPE_DISC 0.09   // m, radius of the disc
#define DRAPE_CLOTH 0.15  // m, of the specimen
#define DRAPE_SCATTER 5.0 // %, half width of the band around a measured coefficient

/// A fabric and its coefficient as others measured them.
typedef struct drape_fabric
{
    const char* name;
    double bending; ///< B, gf cm^2 / cm
    double weight;  ///< mg / cm^2
    double drape;   ///< coefficient, %
} drape_fabric;

enum
{
    DRAPE_FABRICS = 4,
};

/// Of Matsudaira, Masuda, Wada and Yokura 2015, tables 1 and 2.
extern const drape_fabric drape_fabrics[DRAPE_FABRICS];

double drape_rigidity( const drape_fabric* fabric ); ///< N m
double drape_density( const drape_fabric* fabric );  ///< kg/m^2

accuracy_scene_fn validate_drape;
