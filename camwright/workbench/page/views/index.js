// What stands beside the plots, in the order of the tabs.

import { show as audit } from "./audit.js";
import { show as bender } from "./bender.js";
import { show as checks } from "./checks.js";
import { show as compare } from "./compare.js";
import { show as limits } from "./far.js";
import { show as machine } from "./machine.js";
import { show as envelope } from "./map.js";
import { show as recipe } from "./recipe.js";
import { show as servo } from "./servo.js";
import { show as tables } from "./tables.js";
import { show as tradeoff } from "./tradeoff.js";

export const VIEWS = { checks, servo, compare, tradeoff, limits, envelope, export: tables, recipe, audit, machine, bender };

/** Views that are made anew for each design; the others say that they are of an earlier job. */
export const FOLLOWING = new Set(["checks", "servo", "compare", "limits"]);
