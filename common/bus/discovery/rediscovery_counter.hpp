// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <map>

#include "common/bus/discovery/peers.hpp"

namespace eti::bus {

/// Counts identifiers that go and come back. Single-threaded.
template <class Id>
class RediscoveryCounter {
  public:
    /// Bounds memory use on a hostile network; of more that have gone, none is remembered.
    static constexpr std::size_t max_gone = 4096;

    /// `by_departure`: its departure was announced; otherwise it fell silent.
    void on_gone(const Id& id, bool by_departure) {
        if (gone_.size() < max_gone) {
            gone_[id] = by_departure;
        }
    }
    void on_discovered(const Id& id) {
        if (const auto gone = gone_.find(id); gone != gone_.end()) {
            ++(gone->second ? counts_.after_departure : counts_.after_silence);
            gone_.erase(gone);
        }
    }
    /// Forgets those for which `is_it(id)`.
    template <class Predicate>
    void forget(const Predicate& is_it) {
        std::erase_if(gone_, [&](const auto& one) { return is_it(one.first); });
    }
    [[nodiscard]] const Rediscoveries& counts() const { return counts_; }

  private:
    std::map<Id, bool> gone_;
    Rediscoveries counts_;
};

}  // namespace eti::bus
