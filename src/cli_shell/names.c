/* names.c - names of files: UTF-8 everywhere.
 *
 * Systems other than Windows take the bytes as they are. There, names are UTF-16 outside and the calls of C's
 * library take a code page that cannot hold all of them, so the command line is taken from the system, and
 * every call here passes wide names. A file replaces another by its rename, as elsewhere. What the program
 * says has the same bytes too: no line ends in CR LF. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define NAMES_POSIX     1
#else
#define NAMES_POSIX 0
#endif

#include "cli_shell/shell.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if NAMES_POSIX
#include <sys/stat.h>
#endif

#if defined(_WIN32)

#include <direct.h>
#include <fcntl.h>
#include <io.h>
#include <windows.h>
/* after windows.h, which it needs */
#include <shellapi.h>

enum { NAME_MODE = 8 };

/* To be freed; errno stays. NULL with errno, also where the bytes are not UTF-8. */
static wchar_t *wide_name(const char *name)
{
    int const room = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, name, -1, NULL, 0);
    wchar_t *const wide = room > 0 ? malloc((size_t)room * sizeof *wide) : NULL;
    if (wide == NULL) errno = room > 0 ? ENOMEM : ENOENT;
    else MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, name, -1, wide, room);
    return wide;
}

/* Of what stands there, to look at and not to read. */
static HANDLE handle_of(const char *name)
{
    DWORD const others = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
    wchar_t *const wide = wide_name(name);
    HANDLE file = INVALID_HANDLE_VALUE;
    /* Folders are opened with this flag only. */
    if (wide != NULL)
        file = CreateFileW(wide, 0, others, NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);
    free(wide);
    return file;
}

FILE *cli_open_file(const char *name, const char *mode)
{
    wchar_t *const wide = wide_name(name);
    wchar_t wide_mode[NAME_MODE];
    FILE *file = NULL;
    if (wide == NULL) return NULL;
    for (int i = 0; i < NAME_MODE; i++) {
        wide_mode[i] = (wchar_t)mode[i];
        if (mode[i] == 0) break;
    }
    if (cli_kind_of_name(name) == CLI_NAME_FOLDER) errno = EISDIR;
    else file = _wfopen(wide, wide_mode);
    free(wide);
    return file;
}

int cli_remove_file(const char *name)
{
    wchar_t *const wide = wide_name(name);
    int const status = wide != NULL ? _wremove(wide) : -1;
    free(wide);
    return status;
}

int cli_rename_file(const char *from, const char *to)
{
    wchar_t *const wide_from = wide_name(from), *const wide_to = wide_name(to);
    int status = -1;
    if (wide_from != NULL && wide_to != NULL) {
        /* rename of the C library does not replace a file here. */
        status = MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING) ? 0 : -1;
        if (status != 0) errno = GetLastError() == ERROR_FILE_NOT_FOUND ? ENOENT : EACCES;
    }
    free(wide_from);
    free(wide_to);
    return status;
}

int cli_make_folder(const char *name)
{
    wchar_t *const wide = wide_name(name);
    int const status = wide != NULL ? _wmkdir(wide) : -1;
    free(wide);
    return status == 0 || cli_kind_of_name(name) == CLI_NAME_FOLDER ? 0 : -1;
}

int cli_kind_of_name(const char *name)
{
    wchar_t *const wide = wide_name(name);
    DWORD const what = wide != NULL ? GetFileAttributesW(wide) : INVALID_FILE_ATTRIBUTES;
    /* A folder is known by its attributes; devices have none, and are known by being opened. */
    free(wide);
    if (what != INVALID_FILE_ATTRIBUTES && (what & FILE_ATTRIBUTE_DIRECTORY) != 0) return CLI_NAME_FOLDER;
    HANDLE const file = handle_of(name);
    if (file == INVALID_HANDLE_VALUE) return CLI_NAME_NONE;
    DWORD const type = GetFileType(file);
    CloseHandle(file);
    return type == FILE_TYPE_DISK ? CLI_NAME_FILE : CLI_NAME_DEVICE;
}

int cli_same_name(const char *a, const char *b)
{
    wchar_t *const wide_a = wide_name(a), *const wide_b = wide_name(b);
    int same = strcmp(a, b) == 0;
    if (wide_a != NULL && wide_b != NULL)
        same = CompareStringOrdinal(wide_a, -1, wide_b, -1, TRUE) == CSTR_EQUAL;
    free(wide_a);
    free(wide_b);
    return same;
}

/* The numbers of volume and file, which all names and links of a file share. */
static int file_identity(const char *name, BY_HANDLE_FILE_INFORMATION *identity)
{
    HANDLE const file = handle_of(name);
    if (file == INVALID_HANDLE_VALUE) return 0;
    int const good = GetFileInformationByHandle(file, identity) != 0;
    CloseHandle(file);
    return good;
}

int cli_are_one_file(const char *a, const char *b)
{
    BY_HANDLE_FILE_INFORMATION s, t;
    return file_identity(a, &s) && file_identity(b, &t) && s.dwVolumeSerialNumber == t.dwVolumeSerialNumber &&
           s.nFileIndexHigh == t.nFileIndexHigh && s.nFileIndexLow == t.nFileIndexLow;
}

/* The words last as long as the program, so nobody frees them. */
char **cli_words(int *count, char **word)
{
    int words = 0;
    wchar_t **const wide = CommandLineToArgvW(GetCommandLineW(), &words);
    char **utf8 = wide != NULL ? calloc((size_t)words + 1, sizeof *utf8) : NULL;

    _setmode(_fileno(stdin), _O_BINARY);
    _setmode(_fileno(stdout), _O_BINARY);
    _setmode(_fileno(stderr), _O_BINARY);

    for (int i = 0; i < words && utf8 != NULL; i++) {
        int const room = WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, NULL, 0, NULL, NULL);
        utf8[i] = room > 0 ? malloc((size_t)room) : NULL;
        if (utf8[i] == NULL) utf8 = NULL;
        else WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, utf8[i], room, NULL, NULL);
    }
    if (wide != NULL) LocalFree(wide);
    if (utf8 == NULL) return word;
    *count = words;
    return utf8;
}

#else

FILE *cli_open_file(const char *name, const char *mode)
{
    return fopen(name, mode);
}

int cli_remove_file(const char *name)
{
    return remove(name);
}

int cli_rename_file(const char *from, const char *to)
{
    return rename(from, to);
}

int cli_same_name(const char *a, const char *b)
{
    return strcmp(a, b) == 0;
}

int cli_are_one_file(const char *a, const char *b)
{
#if NAMES_POSIX
    struct stat s, t;
    return stat(a, &s) == 0 && stat(b, &t) == 0 && s.st_dev == t.st_dev && s.st_ino == t.st_ino;
#else
    return strcmp(a, b) == 0;
#endif
}

char **cli_words(int *count, char **word)
{
    (void)count;
    return word;
}

#endif
