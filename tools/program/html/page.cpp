#include "tools/program/html/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "tasks/run/saved_start.hpp"
#include "tools/program/text/markup.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

std::string_view asset(std::string_view name) {
    const auto found = std::ranges::find(assets(), name, &Asset::name);
    if (found != assets().end()) return found->text;
    throw std::runtime_error(fmt::format(
        "reports require {}, which was missing when this program was built: install Debian's libjs-dygraphs and libjs-three, or run npm ci "
        "in tools/program/html/browser, then configure and build again; cvtflow plot requires neither",
        name));
}

namespace {

std::string base64(std::span<const std::byte> bytes) {
    static constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8U | (at + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[at + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k) text += at + k > bytes.size() ? '=' : letters[group >> (18U - 6U * k) & 63U];
    }
    return text;
}

/// JSON, escaped for a script element.
std::string in_script(const nlohmann::json& json) {
    std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos; at += 6) text.replace(at, 1, "\\u003c");
    return text;
}

/// Content of a script element.
std::string script(std::string_view name) { return fmt::format("\n{}\n", asset(name)); }

/// Content security policy: only scripts of this program run, identified by hash; none from a record.
std::string policy_of(const Page& page) {
    std::string scripts;
    for (const std::string& name : page.scripts) {
        const std::string text = script(name);
        scripts += fmt::format(" 'sha256-{}'", base64(sha256(std::as_bytes(std::span<const char>(text)))));
    }
    return fmt::format(
        "default-src 'none'; script-src{}; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'",
        scripts.empty() ? " 'none'" : scripts);
}

/// Style of the library that draws curves, if the page uses it.
std::string_view style_of(const Page& page) {
    static constexpr std::string_view library = "dygraph.min.js";
    return std::ranges::count(page.scripts, library) > 0 ? asset("dygraph.min.css") : std::string_view{};
}

/// Licences of the scripts by others, as a comment: the part of licenses.txt before the first line of dashes.
std::string notice_of(const Page& page) {
    const bool foreign = std::ranges::any_of(page.scripts, [](const std::string& name) { return name.ends_with(".min.js"); });
    const std::string_view text = asset("licenses.txt");
    return foreign ? fmt::format("<!--\n{}-->\n", text.substr(0, text.find("\n--") + 1)) : std::string{};
}

/// A value as text; of a long table its beginning, how many points it has, and its unit.
std::string brief_value(const std::string& value) {
    constexpr std::size_t longest = 160;
    const auto end = value.rfind("], [", longest);
    if (value.size() <= longest || end == std::string::npos) return value;
    return fmt::format("{}], … ({} points){}", value.substr(0, end), std::count(value.begin(), value.end(), '[') - 1,
                       value.substr(value.rfind(']') + 1));
}

}  // namespace

std::string packed(std::span<const float> values) { return base64(std::as_bytes(values)); }
std::string packed(std::span<const double> values) { return base64(std::as_bytes(values)); }

nlohmann::json quantised(std::span<const float> values) {
    float from = INFINITY, to = -INFINITY;
    for (const float value : values) {
        if (std::isfinite(value)) from = std::min(from, value), to = std::max(to, value);
    }
    if (!(from <= to)) from = to = 0.0F;
    std::vector<std::uint16_t> whole;
    whole.reserve(values.size());
    for (const float value : values) {
        const float share = to > from && std::isfinite(value) ? (value / 2 - from / 2) / (to / 2 - from / 2) : 0.0F;
        whole.push_back(static_cast<std::uint16_t>(std::lround(65535.0F * share)));
    }
    return {{"from", from}, {"to", to}, {"v", base64(std::as_bytes(std::span<const std::uint16_t>(whole)))}};
}

std::string number_cell(double number, const char* format) {
    if (!std::isfinite(number)) return "<td class=\"number\">–</td>";
    return fmt::format("<td class=\"number\" data-value=\"{:.9g}\">{}</td>", number, fmt::format(fmt::runtime(format), number));
}

std::string table(std::string_view kind, std::string_view caption, std::initializer_list<std::string_view> headings,
                  std::string_view rows) {
    std::string text = kind.empty() ? "<table>" : fmt::format("<table class=\"{}\">", kind);
    if (!caption.empty()) text += fmt::format("<caption>{}</caption>", caption);
    text += "<thead><tr>";
    for (const std::string_view heading : headings) text += fmt::format("<th>{}</th>", heading);
    return text + fmt::format("</tr></thead><tbody>\n{}</tbody></table>\n", rows);
}

std::string attribute_table(const std::vector<engine::Attribute>& attributes) {
    std::vector<std::pair<std::string, std::string>> rows;
    std::string texts;
    for (const engine::Attribute& each : attributes) {
        if (each.name == tasks::step_taken_attribute) continue;  // beside "step"
        const std::string value = each.name == "step" ? step_text(attributes) : value_text(each);
        if (value.find('\n') == std::string::npos)
            rows.emplace_back(each.name, html(value));
        else
            texts += fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", html(each.name), html(value));
    }
    return definition_table(rows) + texts;
}

std::string default_differences(const std::vector<tasks::KeyDifference>& keys, std::string_view shared_by) {
    std::string rows;
    for (const tasks::KeyDifference& each : keys)
        rows += fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n", each.key->key,
                            html(brief_value(each.a)), html(each.b), html(each.key->meaning));
    if (rows.empty())
        return fmt::format("<p>Every key {} has its default.</p>\n",
                           shared_by.empty() ? "of the scene" : fmt::format("that the {} share", shared_by));
    std::string shown = table("", "", {"key", "here", "default", "meaning"}, rows);
    shown.insert(shown.size() - 1, "</details>");
    return fmt::format("<details><summary>{} from defaults{}</summary>{}", plural(static_cast<long>(keys.size()), "difference"),
                       shared_by.empty() ? "" : fmt::format(", common to all {}", shared_by), shown);
}

std::string definition_table(const std::vector<std::pair<std::string, std::string>>& rows) {
    std::string text = "<table class=\"pairs\"><tbody>\n";
    for (const auto& [heading, cell] : rows) text += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", html(heading), cell);
    return text + "</tbody></table>\n";
}

std::string text_of(const Page& page) {
    std::string text = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n<link "
        "rel=\"icon\" href=\"data:,\">\n"
        "<title>{}</title>\n<style>\n{}\n{}\n</style>\n</head>\n<body>\n<header>\n<h1>{}</h1>\n{}<nav aria-label=\"Sections\">",
        policy_of(page), html(page.title), style_of(page), asset("report.css"), html(page.title), page.lead);
    for (const Section& section : page.sections) text += fmt::format("<a href=\"#{}\">{}</a> ", section.id, html(section.title));
    text += "<button type=\"button\" id=\"theme\" aria-pressed=\"false\">dark</button></nav>\n</header>\n<main>\n";
    for (const Section& section : page.sections)
        text += fmt::format("<section id=\"{}\" aria-labelledby=\"{}-title\">\n<h2 id=\"{}-title\">{}</h2>\n{}</section>\n", section.id,
                            section.id, section.id, html(section.title), section.body);
    text += fmt::format("</main>\n<script type=\"application/json\" id=\"data\">{}</script>\n", in_script(page.data));
    for (const std::string& name : page.scripts) text += fmt::format("<script>{}</script>\n", script(name));
    return text + "</body>\n</html>\n" + notice_of(page);
}

}  // namespace cvtflow::tools
