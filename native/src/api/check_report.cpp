// SPDX-License-Identifier: GPL-3.0-or-later
#include "api/check_report.h"

namespace ajar {

namespace {

nlohmann::json state_json(const StateCheck& c) {
    return {{"state", c.state.name}, {"weights", c.state.weights},   {"points", c.points},
            {"ratio", c.ratio},      {"ratio_error", c.ratio_error}, {"far_share", c.far_share}};
}

} // namespace

nlohmann::json check_json(const SelfCheck& c) {
    if (!c.not_checked.empty()) return {{"not_checked", c.not_checked}};
    nlohmann::json out = state_json(c.worst()), states = nlohmann::json::array();
    for (const StateCheck& s : c.states) states.push_back(state_json(s));
    out["states"] = std::move(states);
    return out;
}

nlohmann::json check_report_json(const SelfCheck& c) {
    nlohmann::json out = check_json(c);
    out.update(
        {{"bounce_gain", c.bounce_gain.gain}, {"bounce_gain_error", c.bounce_gain.error}, {"seconds", c.seconds}});
    return out;
}

} // namespace ajar
