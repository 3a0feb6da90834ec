#pragma once

/// titop: from a block diagram of flexible bodies to one minimal state-space model.
#include <titop/blocks/axis.hpp>
#include <titop/blocks/beam.hpp>
#include <titop/blocks/bushing.hpp>
#include <titop/blocks/fe/calculix.hpp>
#include <titop/blocks/fe/mesh.hpp>
#include <titop/blocks/fe/mesh_checks.hpp>
#include <titop/blocks/flexible_body.hpp>
#include <titop/blocks/hinge.hpp>
#include <titop/blocks/joint.hpp>
#include <titop/blocks/modal_checks.hpp>
#include <titop/blocks/port_hamiltonian.hpp>
#include <titop/blocks/rigid_body.hpp>
#include <titop/blocks/slide.hpp>
#include <titop/blocks/spring_mass.hpp>
#include <titop/compiler/dot.hpp>
#include <titop/compiler/minimize.hpp>
#include <titop/compiler/modal.hpp>
#include <titop/compiler/sweep.hpp>
#include <titop/compiler/system.hpp>
#include <titop/compiler/transfer.hpp>
#include <titop/graph/diagram.hpp>
#include <titop/graph/invert.hpp>
#include <titop/graph/mount.hpp>
#include <titop/graph/nodes/gain.hpp>
#include <titop/graph/nodes/lti.hpp>
