// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/sleep.hpp"

#include <algorithm>
#include <numeric>

#include "server/parallel/loops.hpp"

namespace eti::pbd {

namespace {

constexpr std::size_t sleep_grain = 2048;  // minimum number of particles per task

using Lists = std::vector<std::vector<std::uint32_t>>;

void flatten(Lists& lists, std::vector<std::uint32_t>& first, std::vector<std::uint32_t>& all) {
    first.assign(1, 0);
    all.clear();
    for (std::vector<std::uint32_t>& list : lists) {
        std::ranges::sort(list);
        const auto repeated = std::ranges::unique(list);
        list.erase(repeated.begin(), repeated.end());
        all.insert(all.end(), list.begin(), list.end());
        first.push_back(static_cast<std::uint32_t>(all.size()));
    }
}

// For each particle, its positions in `all`.
void invert(const std::vector<std::uint32_t>& all, std::size_t count, std::vector<std::uint32_t>& first,
            std::vector<std::uint32_t>& places) {
    first.assign(count + 1, 0);
    for (const std::uint32_t i : all) {
        ++first[i + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    places.resize(all.size());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t k = 0; k < all.size(); ++k) {
        places[next[all[k]]++] = k;
    }
}

std::vector<std::uint32_t> owners(const std::vector<std::uint32_t>& first, std::size_t places) {
    std::vector<std::uint32_t> owner(places);
    for (std::uint32_t g = 0; g + 1 < first.size(); ++g) {
        std::fill(owner.begin() + first[g], owner.begin() + first[g + 1], g);
    }
    return owner;
}

}  // namespace

void Sleep::configure(const Particles& particles, const ShapeMatching& shapes,
                      std::span<const Constraint::Pair> coupled_pairs, const std::vector<bool>& mesh,
                      const Settings& settings) {
    settings_ = settings;
    const std::size_t count = particles.size();
    const std::size_t blocks = shapes.blocks();
    const auto in_mesh = [&](std::uint32_t i) {
        return !mesh.empty() && mesh[i] && particles.inverse_mass[i] > 0.0f;
    };
    Lists tied(count);
    for (const auto& [a, b] : coupled_pairs) {
        tied[a].push_back(b);
        tied[b].push_back(a);
    }
    Lists moves(blocks + 2), reads(blocks + 2);
    std::vector<bool> moved(count, false);
    const auto move = [&](std::size_t group, std::uint32_t i) {
        moves[group].push_back(i);
        reads[group].push_back(i);
        reads[group].insert(reads[group].end(), tied[i].begin(), tied[i].end());
        moved[i] = true;
    };
    for (std::uint32_t i = 0; i < count; ++i) {
        if (in_mesh(i)) {
            move(blocks, i);
        }
    }
    for (std::size_t c = 0; c < shapes.size(); ++c) {
        const Indices members = shapes.members_of(c);
        const std::size_t block = c / ShapeMatching::block_size;
        for (const std::uint32_t i : members) {
            // The mesh alone decides when its particles sleep: awake without it, they would yield to
            // clusters.
            if (!in_mesh(i) && particles.inverse_mass[i] > 0.0f) {
                move(block, i);
            }
        }
        reads[block].insert(reads[block].end(), members.begin(), members.end());
        if (std::ranges::any_of(members, in_mesh)) {
            reads[blocks].insert(reads[blocks].end(), members.begin(), members.end());
        }
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!moved[i]) {
            move(blocks + 1, i);
        }
    }
    flatten(moves, first_move_, moves_);
    flatten(reads, first_read_, reads_);
    invert(reads_, count, first_slot_, slots_);
    group_of_slot_ = owners(first_read_, reads_.size());
    invert(moves_, count, first_mover_, movers_);
    const std::vector<std::uint32_t> group_of_move = owners(first_move_, moves_.size());
    for (std::uint32_t& place : movers_) {
        place = group_of_move[place];
    }
    awake_movers_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        awake_movers_[i] = static_cast<std::uint16_t>(first_mover_[i + 1] - first_mover_[i]);
    }
    slept_at_.assign(reads_.size(), Vec3f::Zero());
    asleep_.assign(blocks + 2, 0);
    box_.assign(blocks + 2, {});
    group_age_.assign(blocks + 2, 0);
    last_moving_slot_.assign(first_read_.begin(), first_read_.end() - 1);
    still_at_.assign(count, Vec3f::Zero());
    age_.assign(count, 0);
    watched_.reserve(slots_.size());
    groups_ = 0;
    for (std::size_t g = 0; g < asleep_.size(); ++g) {
        groups_ += first_move_[g] < first_move_[g + 1] ? 1 : 0;
    }
    sleeping_ = 0;
    changed_ = restart_ = true;
}

void Sleep::wake_all(Particles& particles) {
    if (sleeping_ > 0) {
        std::ranges::fill(asleep_, std::uint8_t{0});
        std::ranges::fill(particles.asleep, std::uint8_t{0});
        for (std::size_t i = 0; i < awake_movers_.size(); ++i) {
            awake_movers_[i] = static_cast<std::uint16_t>(first_mover_[i + 1] - first_mover_[i]);
        }
        sleeping_ = 0;
        changed_ = true;
    }
    restart_ = true;
}

void Sleep::wake(Particles& particles, std::uint32_t particle) {
    if (!enabled()) {
        return;
    }
    for (std::uint32_t k = first_mover_[particle]; k < first_mover_[particle + 1]; ++k) {
        wake_group(particles, movers_[k]);
    }
}

void Sleep::wake_group(Particles& particles, std::uint32_t group) {
    if (asleep_[group] == 0) {
        return;
    }
    asleep_[group] = 0;
    group_age_[group] = 0;
    --sleeping_;
    changed_ = true;
    for (const std::uint32_t i : moves(group)) {
        if (awake_movers_[i]++ == 0) {
            particles.asleep[i] = 0;
            still_at_[i] = particles.position[i];
            age_[i] = 0;
        }
    }
}

void Sleep::put_to_sleep(Particles& particles, std::uint32_t group) {
    asleep_[group] = 1;
    ++sleeping_;
    changed_ = true;
    for (std::uint32_t slot = first_read_[group]; slot < first_read_[group + 1]; ++slot) {
        slept_at_[slot] = particles.position[reads_[slot]];
    }
    box_[group].setEmpty();
    for (const std::uint32_t i : moves(group)) {
        box_[group].extend(particles.position[i]);
        if (--awake_movers_[i] == 0) {
            particles.asleep[i] = 1;
            particles.predicted[i] = particles.position[i];
            particles.velocity[i].setZero();
        }
    }
}

bool Sleep::update_awake(Particles& particles) {
    if (!changed_) {
        return false;
    }
    changed_ = false;
    particles.awake.clear();
    watched_.clear();
    const auto count = static_cast<std::uint32_t>(particles.size());
    if (all_awake()) {
        particles.awake.push_back({0, count});
    }
    for (std::uint32_t i = 0; i < count && !all_awake(); ++i) {
        if (particles.asleep[i] != 0) {
            continue;
        }
        if (particles.awake.empty() || particles.awake.back()[1] != i) {
            particles.awake.push_back({i, i});
        }
        particles.awake.back()[1] = i + 1;
        for (std::uint32_t k = first_slot_[i]; k < first_slot_[i + 1]; ++k) {
            if (asleep_[group_of_slot_[slots_[k]]] != 0) {
                watched_.push_back(slots_[k]);
            }
        }
    }
    return true;
}

void Sleep::update_rest_counters(const Particles& particles) {
    const float squared = settings_.still * settings_.still;
    const auto count = [&](std::size_t i) {
        // NaN never counts as still.
        if ((particles.position[i] - still_at_[i]).squaredNorm() <= squared) {
            age_[i] = static_cast<std::uint8_t>(std::min(age_[i] + 1, settings_.steps));
        } else {
            still_at_[i] = particles.position[i];
            age_[i] = 0;
        }
    };
    for (const auto& run : particles.awake) {
        const std::size_t first = run[0];
        parallel::for_each(run[1] - first, sleep_grain, [&](std::size_t k) { count(first + k); });
    }
}

bool Sleep::is_still(std::uint32_t group) {
    if (age_[reads_[last_moving_slot_[group]]] < settings_.steps) {
        return false;
    }
    for (std::uint32_t slot = first_read_[group]; slot < first_read_[group + 1]; ++slot) {
        if (age_[reads_[slot]] < settings_.steps) {
            last_moving_slot_[group] = slot;
            return false;
        }
    }
    return true;
}

void Sleep::end_step(Particles& particles) {
    if (restart_) {
        restart_ = false;
        still_at_ = particles.position;
        std::ranges::fill(age_, std::uint8_t{0});
        std::ranges::fill(group_age_, std::uint8_t{0});
        return;
    }
    update_rest_counters(particles);
    const float squared = settings_.shift * settings_.shift;
    for (const std::uint32_t slot : watched_) {
        if (!((particles.position[reads_[slot]] - slept_at_[slot]).squaredNorm() <= squared)) {
            wake_group(particles, group_of_slot_[slot]);
        }
    }
    for (std::uint32_t g = 0; g < asleep_.size(); ++g) {
        if (asleep_[g] != 0 || first_move_[g] == first_move_[g + 1]) {
            continue;
        }
        group_age_[g] = static_cast<std::uint8_t>(std::min(group_age_[g] + 1, settings_.steps));
        if (group_age_[g] == settings_.steps && is_still(g) && !(mesh_creeps_ && g == mesh())) {
            put_to_sleep(particles, g);
        }
    }
}

}  // namespace eti::pbd
