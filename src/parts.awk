# parts.awk - the sources that some calls of the library need, for amalgamate.sh.
#     awk -f src/parts.awk -v parts="solid surface levels" include/bitvox.h include/bitvox_io.h HEADERS... SOURCES...
# A part is a word, or several joined by _, of public functions' names: "levels" stands for bvx_build_levels. Calls that
# begin with read, write, render or octree are meant only by parts that begin so too: "write_mesh", "read". Contexts, lattices, and
# what frees or fills the types of the calls come with every part.
# A source is needed when it defines a name that a needed source, or a header that one includes, uses; so the calls decide, nothing
# is listed by hand. Conditional code counts whatever the condition, so one set of files serves every machine. Prints the sources in
# their order, then each public function that none of them defines after a "-".
function strip(text,    left, at) { # without comments, and strings empty: names in words are not calls
    gsub(/\\./, "", text)
    gsub(/"[^"]*"/, "\"\"", text)
    while (text != "") {
        at = index(text, inside ? "*/" : "/*")
        if (!inside) left = left (at ? substr(text, 1, at - 1) " " : text)
        if (!at) break
        text = substr(text, at + 2)
        inside = !inside
    }
    return left
}

function need(file,    i, count, name, list, of) {
    if (file == "" || needed[file]++) return
    count = split(names[file], list, " ")
    for (i = 1; i <= count; i++) need_name(list[i])
    count = split(includes[file], list, " ")
    for (i = 1; i <= count; i++) {
        of = file
        sub(/[^\/]*$/, "", of)
        if (("src/" list[i]) in known) need("src/" list[i])
        else need(of list[i])
    }
}

function need_name(name,    i, count, list) {
    if (wanted[name]++) return
    count = split(defined_in[name], list, " ")
    for (i = 1; i <= count; i++) need(list[i])
}

function has_words(name, words) {
    if (match(name, /^bvx_(read|write|render|octree)_/) && index(words "_", substr(name, 5, RLENGTH - 4)) != 1) return 0
    return index(substr(name, 4) "_", "_" words "_") > 0
}

FNR == 1 { inside = 0; head = ""; public = FILENAME ~ /^include/; known[FILENAME] = 1; order[++files] = FILENAME }
/^[ \t]*#[ \t]*include[ \t]*"/ {
    split($0, quoted, "\"")
    if (quoted[2] !~ /^bitvox/) includes[FILENAME] = includes[FILENAME] " " quoted[2]
    next
}
{ line = strip($0) }

# Declarations of the public header.
public {
    if (line ~ /^BVX_API /) declaring = 1
    if (!declaring) next
    head = head " " line
    if (line !~ /;/) next
    match(head, /bvx_[a-z0-9_]*\(/)
    call = substr(head, RSTART, RLENGTH - 1)
    calls[++call_count] = call
    signature[call] = head
    head = ""
    declaring = 0
    next
}

# Of a source, what begins at the margin without static and ends in a body or a value is defined here. In a header such lines declare.
FILENAME ~ /\.c$/ && (head != "" || (line ~ /^[a-z]/ && line !~ /^(static|typedef|extern)/)) {
    head = head " " line
    if (line ~ /;[ ]*$/ && head !~ /=/) head = ""
    else if (line ~ /\{/ || head ~ /=/) {
        if (match(head, /bvxi?_[a-z0-9_]+ *(\(|\[|=)/)) {
            name = substr(head, RSTART, RLENGTH)
            gsub(/[^a-z0-9_]/, "", name)
            defined_in[name] = defined_in[name] " " FILENAME
        }
        head = ""
    }
}
FILENAME ~ /\.h$/ && line ~ /^[a-z]/ { next }
{
    while (match(line, /bvxi?_[a-z0-9_]+/)) {
        name = substr(line, RSTART, RLENGTH)
        line = substr(line, RSTART + RLENGTH)
        if (!((FILENAME, name) in used)) {
            used[FILENAME, name] = 1
            names[FILENAME] = names[FILENAME] " " name
        }
    }
}

END {
    count = split(parts, part, " ")
    for (p = 1; p <= count; p++) {
        found = 0
        for (c = 1; c <= call_count; c++)
            if (has_words(calls[c], part[p])) found = root[calls[c]] = 1
        if (!found) {
            print "amalgamate: no public function has the word '" part[p] "'; a part is a word of such names, like solid or extract_surface" >"/dev/stderr"
            exit 1
        }
    }
    for (c = 1; c <= call_count; c++)
        if (calls[c] ~ /^bvx_(context|lattice|status|reason|memory|version|last|arithmetic)(_|$)/) root[calls[c]] = 1
    for (c = 1; c <= call_count; c++)
        if (calls[c] ~ /_(free|init)$/) {
            type = calls[c]
            sub(/_(free|init)$/, "", type)
            for (call in root)
                if (signature[call] ~ ("(^|[^a-z_])" type "[^a-z_]")) helper[calls[c]] = 1
        }
    for (call in root) need_name(call)
    for (call in helper) need_name(call)
    for (f = 1; f <= files; f++)
        if (needed[order[f]] && order[f] ~ /\.c$/) print order[f]
    for (c = 1; c <= call_count; c++) {
        count = split(defined_in[calls[c]], list, " ")
        have = 0
        for (i = 1; i <= count; i++) have += needed[list[i]]
        if (!have) print "-" calls[c]
    }
}
