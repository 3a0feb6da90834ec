#pragma once

/// titop: from a block diagram of flexible bodies to one minimal state-space model.
#include <titop/blocks/spring_mass.hpp>
#include <titop/compiler/dot.hpp>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/system.hpp>
#include <titop/compiler/transfer.hpp>
#include <titop/graph/diagram.hpp>
#include <titop/graph/mount.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>
