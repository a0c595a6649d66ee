// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

// What a transport of one's own is made of, beyond names.hpp.
#if ETI_FASTDDS >= 3
#include <fastdds/rtps/attributes/PropertyPolicy.hpp>
#include <fastdds/rtps/common/LocatorSelector.hpp>
#include <fastdds/rtps/common/PortParameters.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/TransportInterface.hpp>
#else
#include <fastdds/rtps/attributes/PropertyPolicy.h>
#include <fastdds/rtps/common/PortParameters.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/TransportInterface.h>

#include <fastdds/rtps/common/LocatorSelector.hpp>
#endif
