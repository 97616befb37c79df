// What a method that is requested may not deliver: the method auto would take another.
#pragma once

#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Throws a Refusal where a method is requested and its fill folds more than its rim does or, if it is no surface of the surroundings as
/// a whole, goes through itself. Who shapes the patch, or wants the method's own without fairing, has it as it is, with a warning; under auto
/// others were tried.
void refuse_if_insisted(const FillContext& context, const Fill& fill, const FillOptions& options);

}  // namespace tripatch
