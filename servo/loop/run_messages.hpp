// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "servo/loop/run.hpp"

namespace spm::servo {

/// What is served, how, at which rate, on which device, and how to end it: one sentence.
[[nodiscard]] std::string start_message(const RunOptions& options, const ForceScene& scene,
                                        const std::vector<KeeperReport>& assets,
                                        const std::vector<std::string>& paths,
                                        const std::vector<Device*>& devices);

/// Whether the simulated device was taken because no other is plugged in.
[[nodiscard]] bool nothing_plugged_in(const RunOptions& options, const ForceChoice& choice,
                                      const std::vector<Device*>& devices);

/// A sentence for each device that cannot be as stiff as the scene asks, and for each that is asked
/// for more than it holds stably (`auto_stiffness`).
[[nodiscard]] std::vector<std::string> stiffness_warnings(const ForceChoice& choice,
                                                          const std::vector<Device*>& devices);

/// A sentence where the workspace's scale leaves nothing to feel: where all objects together are
/// hardly a motion of the hand, or the whole workspace is less than what the assets resolve.
/// `assets`: the reports of the choice's assets.
[[nodiscard]] std::vector<std::string> workspace_warnings(const ForceChoice& choice,
                                                          const std::vector<KeeperReport>& assets,
                                                          const std::vector<Device*>& devices);

/// A sentence for each setting of method paper that was chosen where no object is of it.
[[nodiscard]] std::vector<std::string> paper_warnings(const ForceChoice& choice);

/// What a person has to know of a scene's tool on these devices: a coupling that is named stiffer
/// than the device bears, a device that does not read its
/// orientation, keys of objects that a probe alone feels, a tool that is longer than a workspace,
/// and an object that is narrower than the tool's samples are apart. `assets`: the reports of the
/// choice's assets. Empty where the scene has no such tool.
[[nodiscard]] std::vector<std::string> tool_warnings(const ForceChoice& choice,
                                                     const std::vector<KeeperReport>& assets,
                                                     const std::vector<Device*>& devices);

/// A sentence for each device that turns a scene's tool and gives no torque: what its hand feels.
[[nodiscard]] std::vector<std::string> tool_notes(const ForceChoice& choice,
                                                  const std::vector<Device*>& devices);

}  // namespace spm::servo
